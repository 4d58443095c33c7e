// Compares the filled holes of a virtual scan with the surface that was scanned.
#pragma once

#include "octree/holes/holes.h"
#include "tests/octree/normals/surface_truth.h"

namespace lucarne::octree::testing {

/// Returns the sample of a scan and of its estimate.
inline HoleSample sample_of(const Scan& scan, const Estimate& estimate, bool stations = true) {
    HoleSample sample;
    if (stations)
        for (const glm::dvec3& station : scan.stations) sample.stations.emplace_back(station);
    for (size_t i = 0; i < scan.cloud.points.size(); ++i) {
        if (!(drawn_radius(estimate, i) > 0)) continue;
        sample.points.push_back({.position = glm::vec3(scan.cloud.points[i]),
                                 .normal = estimate.normals[i],
                                 .colour = glm::vec3(0.5f),
                                 .area = estimate.areas[i],
                                 .station = stations ? scan.cloud.stations[i] : -1});
    }
    return sample;
}

struct HoleErrors {
    double through = 0;  ///< share of cosine-distributed rays between true surfaces that pass the discs
    double filled = 0, off = 0;  ///< m^2 of filling; of it, farther than kOff from every true surface
};

/// Adds the filling to the discs of an estimate and casts rays from the true surface.
inline HoleErrors hole_errors(const std::string& scene, Scan scan, Estimate estimate,
                              const std::vector<FillPoint>& filling, size_t rays = 200000) {
    HoleErrors errors;
    const auto geometry = io::SceneGeometry::create(scene);
    EXPECT_TRUE(geometry);
    if (!geometry) return errors;
    const io::SceneGeometry& truth = **geometry;
    for (const FillPoint& point : filling) {
        scan.cloud.points.emplace_back(point.position);
        estimate.normals.push_back(point.normal);
        estimate.areas.push_back(point.area);
        errors.filled += point.area;
        if (!truth.closest(glm::dvec3(point.position), kOff)) errors.off += point.area;
    }
    const DiscScene discs(scan.cloud, estimate);
    const Scan even = scan_of(scene, 50000, true);
    lucarne::Random random(5);
    size_t cast = 0, through = 0;
    for (size_t i = 0; i < rays; ++i) {
        const size_t from = i % even.cloud.points.size();
        const glm::dvec3 n = even.cloud.normals[from];
        const double z = 2 * random.uniform() - 1, a = 2 * std::numbers::pi * random.uniform();
        const double r = std::sqrt(1 - z * z);
        const glm::dvec3 to = glm::normalize(1.0001 * n + glm::dvec3(r * std::cos(a), r * std::sin(a), z));
        const glm::dvec3 origin = even.cloud.points[from] + 1e-3 * n;
        const auto hit = truth.cast(origin, to);
        if (!hit || glm::dot(hit->normal, to) > 0) continue;  // inside a body
        ++cast;
        // Discs around the origin do not count.
        const auto found = discs.cast(origin + std::min(0.1, 0.5 * hit->distance) * to, to);
        through += !found || *found > hit->distance + kOff;
    }
    errors.through = static_cast<double>(through) / static_cast<double>(std::max<size_t>(1, cast));
    return errors;
}

}  // namespace lucarne::octree::testing
