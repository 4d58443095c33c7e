// Compares the discs of an estimate with the true surface of a virtual scan (io/synthetic).
#pragma once

#include <algorithm>
#include <optional>
#include <vector>

#include <embree3/rtcore.h>
#include <fmt/format.h>

#include "io/synthetic/scene_geometry.h"
#include "octree/tree/footprint.h"
#include "tests/octree/normals/virtual_scans.h"

namespace lucarne::octree::testing {

/// Returns the radius with which a point is drawn at full resolution, 0 where it is not drawn.
inline float drawn_radius(const Estimate& estimate, size_t i) {
    const bool stray = estimate.areas[i] <= kStrayArea && estimate.normals[i] == glm::vec3(0.0f);
    return stray || !(estimate.areas[i] > 0) ? 0 : surfel_radius(estimate.areas[i], 0);
}

/// The discs of an estimate, for rays.
class DiscScene {
 public:
    DiscScene(const Cloud& cloud, const Estimate& estimate)
        : device_(rtcNewDevice("threads=1")), scene_(rtcNewScene(device_)) {
        std::vector<float> discs, normals;
        for (size_t i = 0; i < cloud.points.size(); ++i) {
            const glm::vec3 n = estimate.normals[i], p(cloud.points[i]);
            const float radius = drawn_radius(estimate, i);
            if (n == glm::vec3(0.0f) || !(radius > 0)) continue;
            discs.insert(discs.end(), {p.x, p.y, p.z, radius});
            normals.insert(normals.end(), {n.x, n.y, n.z});
        }
        const size_t count = normals.size() / 3;
        const RTCGeometry geometry = rtcNewGeometry(device_, RTC_GEOMETRY_TYPE_ORIENTED_DISC_POINT);
        void* to = rtcSetNewGeometryBuffer(geometry, RTC_BUFFER_TYPE_VERTEX, 0, RTC_FORMAT_FLOAT4, 16, count);
        std::copy(discs.begin(), discs.end(), static_cast<float*>(to));
        to = rtcSetNewGeometryBuffer(geometry, RTC_BUFFER_TYPE_NORMAL, 0, RTC_FORMAT_FLOAT3, 12, count);
        std::copy(normals.begin(), normals.end(), static_cast<float*>(to));
        rtcCommitGeometry(geometry);
        rtcAttachGeometry(scene_, geometry);
        rtcReleaseGeometry(geometry);
        rtcCommitScene(scene_);
    }
    ~DiscScene() {
        rtcReleaseScene(scene_);
        rtcReleaseDevice(device_);
    }
    DiscScene(const DiscScene&) = delete;
    DiscScene& operator=(const DiscScene&) = delete;

    std::optional<double> cast(const glm::dvec3& origin, const glm::dvec3& direction) const {
        RTCIntersectContext context;
        rtcInitIntersectContext(&context);
        RTCRayHit ray{};
        ray.ray.org_x = static_cast<float>(origin.x);
        ray.ray.org_y = static_cast<float>(origin.y);
        ray.ray.org_z = static_cast<float>(origin.z);
        ray.ray.dir_x = static_cast<float>(direction.x);
        ray.ray.dir_y = static_cast<float>(direction.y);
        ray.ray.dir_z = static_cast<float>(direction.z);
        ray.ray.tfar = 1e9f;
        ray.ray.mask = ~0u;
        ray.hit.geomID = RTC_INVALID_GEOMETRY_ID;
        rtcIntersect1(scene_, &context, &ray);
        if (ray.hit.geomID == RTC_INVALID_GEOMETRY_ID) return std::nullopt;
        return ray.ray.tfar;
    }

 private:
    RTCDevice device_;
    RTCScene scene_;
};

struct SurfaceErrors {
    /// Discs in the air: their centre is farther than kOff from every true surface.
    size_t rogue = 0;
    double rogue_area = 0;    ///< m^2, of these discs' faces
    double widest_rogue = 0;  ///< radius, m
    /// Share of the faces of the other discs that is farther than kOff from every true surface.
    double overhang = 0;
    double widest = 0;    ///< largest radius of all discs, m
    double nearer = 0;    ///< share of rays that hit a disc more than kNearer in front of the surface
    double through = 0;   ///< share of rays that hit nothing within kOff behind the surface
    size_t left_out = 0;  ///< points on a surface that are not drawn
    /// Errors of normals in degrees, at creases (within two spacings of them) and elsewhere.
    double crease_p50 = 0, crease_p95 = 0, smooth_p50 = 0, smooth_p95 = 0, p95 = 0;
    double creases = 0;                ///< share of points at creases
    double crease_area = 0, area = 0;  ///< sums of shares, m^2
};

inline constexpr double kOff = 0.05, kNearer = 0.02;

/// Whether the true surface turns by more than 30 degrees within `reach` of a place on it.
inline bool at_crease(const io::SceneGeometry& truth, const io::SurfaceHit& at, double reach) {
    constexpr double kTurned = 0.866;
    const glm::dvec3 n = at.normal;
    const glm::dvec3 side =
        glm::normalize(glm::cross(n, std::abs(n.z) < 0.9 ? glm::dvec3(0, 0, 1) : glm::dvec3(1, 0, 0)));
    const glm::dvec3 up = glm::cross(n, side);
    for (int i = 0; i < 8; ++i) {
        const double a = i * std::numbers::pi / 4;
        const glm::dvec3 along = reach * (std::cos(a) * side + std::sin(a) * up);
        for (const double height : {0.3, -0.3}) {
            const auto hit = truth.closest(at.position + along + height * reach * n, reach);
            if (hit && std::abs(glm::dot(hit->normal, n)) < kTurned) return true;
        }
    }
    return false;
}

inline double quantile(std::vector<double>& values, double q) {
    if (values.empty()) return 0;
    const auto at = values.begin() + static_cast<ptrdiff_t>(q * static_cast<double>(values.size() - 1));
    std::nth_element(values.begin(), at, values.end());
    return *at;
}

/// Measures `rays` rays and every `step`-th normal.
inline SurfaceErrors surface_errors(const std::string& scene, const Scan& scan, const Estimate& estimate,
                                    size_t rays = 100000, size_t step = 7) {
    SurfaceErrors errors;
    const auto geometry = io::SceneGeometry::create(scene);
    EXPECT_TRUE(geometry);
    if (!geometry) return errors;
    const io::SceneGeometry& truth = **geometry;
    const auto& points = scan.cloud.points;
    std::vector<double> crease, smooth, all;
    double face = 0, outside = 0;
    lucarne::Random random(9);
    for (size_t i = 0; i < points.size(); ++i) {
        const auto place = truth.closest(points[i], kOff);
        const float radius = drawn_radius(estimate, i);
        const glm::dvec3 n(estimate.normals[i]);
        errors.left_out += place && !(radius > 0);
        if (!(radius > 0)) continue;
        errors.area += estimate.areas[i];
        errors.widest = std::max<double>(errors.widest, radius);
        const double own_face = std::numbers::pi * radius * radius;
        if (!place) {
            ++errors.rogue;
            errors.rogue_area += own_face;
            errors.widest_rogue = std::max<double>(errors.widest_rogue, radius);
            continue;
        }
        if (n == glm::dvec3(0.0)) continue;
        // A uniform place on the disc.
        const glm::dvec3 u =
            glm::normalize(glm::cross(n, std::abs(n.z) < 0.9 ? glm::dvec3(0, 0, 1) : glm::dvec3(1, 0, 0)));
        const double r = radius * std::sqrt(random.uniform()), a = 2 * std::numbers::pi * random.uniform();
        face += own_face;
        if (!truth.closest(points[i] + r * (std::cos(a) * u + std::sin(a) * glm::cross(n, u)), kOff))
            outside += own_face;
        if (i % step) continue;
        const double error =
            std::acos(std::min(1.0, std::abs(glm::dot(n, scan.cloud.normals[i])))) * 180 / std::numbers::pi;
        const bool turns = at_crease(truth, *place, 2 * std::sqrt(double{estimate.areas[i]}));
        (turns ? crease : smooth).push_back(error);
        all.push_back(error);
    }
    errors.overhang = outside / std::max(face, 1e-9);
    errors.creases =
        static_cast<double>(crease.size()) / static_cast<double>(std::max<size_t>(1, all.size()));
    errors.crease_p50 = quantile(crease, 0.5);
    errors.crease_p95 = quantile(crease, 0.95);
    errors.smooth_p50 = quantile(smooth, 0.5);
    errors.smooth_p95 = quantile(smooth, 0.95);
    errors.p95 = quantile(all, 0.95);
    if (scan.stations.empty() || rays == 0) return errors;

    const DiscScene discs(scan.cloud, estimate);
    size_t cast = 0, nearer = 0, through = 0;
    const auto direction = [&] {
        const double z = 2 * random.uniform() - 1, a = 2 * std::numbers::pi * random.uniform();
        return glm::dvec3(std::sqrt(1 - z * z) * std::cos(a), std::sqrt(1 - z * z) * std::sin(a), z);
    };
    for (size_t i = 0; i < rays; ++i) {
        // From eyes beside the stations.
        const glm::dvec3& station = scan.stations[i % scan.stations.size()];
        const glm::dvec3 aside = direction();
        if (truth.cast(station, aside, 0.7)) continue;
        const glm::dvec3 eye = station + 0.5 * aside, to = direction();
        const auto hit = truth.cast(eye, to);
        if (!hit) continue;
        // What no station saw cannot be right.
        const glm::dvec3 seen = hit->position - 1e-4 * to;
        const bool known = std::any_of(scan.stations.begin(), scan.stations.end(), [&](const glm::dvec3& s) {
            const double range = glm::distance(s, seen);
            const glm::dvec3 ray = (seen - s) / range;
            return ray.z > -0.85 && !truth.cast(s, ray, range - 1e-3);
        });
        if (!known) continue;
        ++cast;
        const auto found = discs.cast(eye, to);
        nearer += found && *found < hit->distance - kNearer;
        through += !found || *found > hit->distance + kOff;
    }
    errors.nearer = static_cast<double>(nearer) / static_cast<double>(std::max<size_t>(1, cast));
    errors.through = static_cast<double>(through) / static_cast<double>(std::max<size_t>(1, cast));
    return errors;
}

inline std::string line_of(const SurfaceErrors& e) {
    return fmt::format(
        "discs in the air {} ({:.2f} m2, radius up to {:.2f} m), {:.2f} % of the others' faces off, widest "
        "{:.2f} m; rays "
        "nearer {:.2f} %, through {:.3f} %; normals at creases ({:.1f} %) p50 {:.2f} p95 {:.1f}, elsewhere "
        "p50 {:.2f} p95 {:.2f}, all p95 {:.1f} degrees; not drawn {}; area {:.2f} m2",
        e.rogue, e.rogue_area, e.widest_rogue, 100 * e.overhang, e.widest, 100 * e.nearer, 100 * e.through,
        100 * e.creases, e.crease_p50, e.crease_p95, e.smooth_p50, e.smooth_p95, e.p95, e.left_out, e.area);
}

}  // namespace lucarne::octree::testing
