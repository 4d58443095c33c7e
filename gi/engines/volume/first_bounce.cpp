#include "gi/engines/volume/first_bounce.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <numeric>
#include <utility>

#include <glm/geometric.hpp>

#include "gi/shared/brdf.h"
#include "gi/shared/luminance.h"
#include "gi/tracing/light_sampling.h"
#include "gi/tree/coverage.h"
#include "gi/volume/disc_areas.h"
#include "io/core/parallel.h"

namespace lucarne::gi::volume {
namespace {

constexpr size_t kReceiversAtOnce = 8192, kReceiversATask = 128;
/// How many lines of sight there are from each face.
constexpr float kLinesOfSight = 48;
/// What reaches less far above a plane lies in it, in voxels.
constexpr float kInPlane = 1e-3f;
/// Lines of sight begin and end at least this far from the sides of a voxel.
constexpr float kInside = 0.1f;
/// So many voxels about the inner grid the light from outside of it is kept apart: faces in it interpolate
/// between those about them.
constexpr float kMargin = 8;

/// Returns how far beyond a grid a position is along any axis, in voxels; negative inside.
float beyond_grid(const Grid& grid, const glm::vec3& position) {
    const glm::vec3 place = grid.place(position), out = glm::max(-place, place - glm::vec3(grid.size));
    return std::max({out.x, out.y, out.z});
}

}  // namespace

float form_factor(const glm::vec3& position, const glm::vec3& normal, const glm::vec3& middle,
                  const glm::vec3& square_normal, float area) {
    if (!(glm::dot(square_normal, position - middle) > 0)) return 0;
    glm::vec3 u, v;
    tracing::frame_of(square_normal, u, v);
    const float half = 0.5f * std::sqrt(area);
    Polygon square;
    for (const glm::vec3& corner : {half * (u + v), half * (v - u), -half * (u + v), half * (u - v)})
        square.add(middle + corner - position);
    // What is below the horizon of the surface is cut off.
    Polygon above;
    for (size_t i = 0; i < square.count; ++i) {
        const glm::vec3 &from = square.corners[i], &to = square.corners[(i + 1) % square.count];
        const float before = glm::dot(from, normal), after = glm::dot(to, normal);
        if (before >= 0) above.add(from);
        if ((before >= 0) != (after >= 0)) above.add(from + (to - from) * (before / (before - after)));
    }
    float sum = 0;
    for (size_t i = 0; i < above.count; ++i) {
        const glm::vec3 &from = above.corners[i], &to = above.corners[(i + 1) % above.count];
        const glm::vec3 across = glm::cross(from, to);
        const float sine = glm::length(across);
        if (!(sine > 0)) continue;
        sum += std::atan2(sine, glm::dot(from, to)) * glm::dot(across, normal) / sine;
    }
    return std::abs(sum) / (2 * kPi);
}

namespace {

/// Returns a place in the air before a face, in units of voxels, from which lines of sight go. Walls of
/// voxels are up to two voxels thick and have steps if they are slanted, so the place is lifted off the
/// surface as far as nothing else is there.
glm::vec3 place_before(const Space& space, const Face& face) {
    const Grid& grid = space.grid();
    const glm::vec3 low(space.cell_before(face)), surface = grid.place(face.position);
    glm::vec3 close = glm::clamp(surface, low + kInside, low + (1 - kInside));
    close[axis_of(face.side)] = low[axis_of(face.side)] + 0.5f;
    for (const float lift : {2.0f, 1.5f, 1.0f}) {
        const glm::vec3 place = surface + lift * face.normal;
        const glm::ivec3 cell(glm::floor(place));
        if (grid.holds(cell) && space.voxels.is_air(cell) && space.air.sees(close, place)) return place;
    }
    return close;
}

}  // namespace

FirstBounce::FirstBounce(const Space& space) : space_(space), places_(space.faces.all().size()) {
    parallel_ranges(places_.size(), kReceiversATask, [&](size_t first, size_t last) {
        for (size_t i = first; i < last; ++i) places_[i] = place_before(space, space.faces.all()[i]);
    });
    order_.resize(places_.size());
    std::iota(order_.begin(), order_.end(), 0u);
    std::ranges::stable_sort(order_, {}, [&](uint32_t face) { return space.faces.all()[face].side; });
}

void FirstBounce::begin(std::span<const glm::vec3> radiance, const Grid* inner) {
    const auto all = space_.faces.all();
    std::array<std::vector<uint32_t>, 2> lit;  // outside of the inner grid, and in it
    apart_.assign(all.size(), 0);
    for (uint32_t face = 0; face < all.size(); ++face) {
        const float beyond = inner ? beyond_grid(*inner, all[face].position) : INFINITY;
        const bool in = beyond <= 0;
        apart_[face] = beyond < kMargin ? 1 : 0;
        if (all[face].area > 0 && luminance(radiance[face]) > 0) lit[in ? 1 : 0].push_back(face);
    }
    clusters_.clear();
    clusters_.reserve(2 * (lit[0].size() + lit[1].size()));
    for (auto& faces : lit) {
        std::ranges::stable_sort(faces, {}, [&](uint32_t face) { return all[face].side; });
        if (!faces.empty()) add_cluster(radiance, faces);
        if (&faces == &lit[0]) outer_clusters_ = clusters_.size();
    }
    irradiance_.assign(all.size(), glm::vec3(0.0f));
    from_outside_.assign(all.size(), glm::vec3(0.0f));
    done_ = 0;
}

/// Adds the cluster of some faces, which become sorted, and those that it consists of.
void FirstBounce::add_cluster(std::span<const glm::vec3> radiance, std::span<uint32_t> faces) {
    const auto all = space_.faces.all();
    Cluster cluster{.low = glm::vec3(INFINITY),
                    .high = glm::vec3(-INFINITY),
                    .faces = static_cast<uint32_t>(faces.size())};
    float weights = 0;
    for (const uint32_t i : faces) {
        const Face& face = all[i];
        const glm::vec3 power = radiance[i] * face.area;
        const float weight = luminance(power);
        // A square in the plane of the face reaches so far along each axis.
        const glm::vec3 reach =
            0.7f * std::sqrt(face.area) * glm::sqrt(glm::max(1.0f - face.normal * face.normal, 0.0f));
        cluster.low = glm::min(cluster.low, face.position - reach);
        cluster.high = glm::max(cluster.high, face.position + reach);
        cluster.middle += weight * face.position;
        cluster.normal += weight * face.normal;
        cluster.power += power;
        cluster.area += face.area;
        weights += weight;
    }
    cluster.middle /= weights;
    cluster.normal /= weights;
    float nearest = INFINITY;
    for (const uint32_t i : faces) {
        const float away = glm::distance(all[i].position, cluster.middle);
        cluster.radius = std::max(cluster.radius, away + 0.7f * std::sqrt(all[i].area));
        if (away >= nearest) continue;
        nearest = away;
        cluster.face = i;
        cluster.voxel = all[i].voxel;
    }
    clusters_.push_back(cluster);
    if (faces.size() == 1) return;
    const size_t half = divide(faces);
    add_cluster(radiance, faces.first(half));
    add_cluster(radiance, faces.subspan(half));
}

/// Returns how many of the faces, which become sorted, the first half of a cluster consists of: those of some
/// sides, or one half of the cluster's longest extent.
size_t FirstBounce::divide(std::span<uint32_t> faces) const {
    const auto all = space_.faces.all();
    const auto side = [&](uint32_t face) { return all[face].side; };
    if (side(faces.front()) != side(faces.back())) {
        // They are sorted by side until only one is left.
        const int border = std::max(side(faces[faces.size() / 2]), side(faces.front()) + 1);
        return static_cast<size_t>(std::ranges::lower_bound(faces, border, {}, side) - faces.begin());
    }
    glm::vec3 low(INFINITY), high(-INFINITY);
    for (const uint32_t face : faces) {
        low = glm::min(low, all[face].position);
        high = glm::max(high, all[face].position);
    }
    const int axis = largest_axis(high - low);
    const size_t half = faces.size() / 2;
    std::ranges::nth_element(faces, faces.begin() + static_cast<ptrdiff_t>(half), {},
                             [&](uint32_t face) { return std::pair(all[face].position[axis], face); });
    return half;
}

/// Computes the light of the rays from nearby faces, and drops those that bring none.
void FirstBounce::finish_nearby(const Receiver& face, Rays& rays) const {
    std::erase_if(rays, [&](Ray& ray) {
        if (ray.luminance != Ray::kNearby) return false;
        const Cluster& cluster = clusters_[ray.cluster];
        const float factor =
            form_factor(face.position, face.normal, cluster.middle, cluster.normal, cluster.area) * kPi /
            cluster.area;
        ray.light = factor * cluster.power;
        ray.luminance = luminance(ray.light);
        return !(factor > 0);
    });
}

/// Returns what a face sees of the rays that have more than their share of the light, and drops them: each
/// is decided by a line of sight of its own, so that no other decides for it. Where most of the light turns
/// out to be hidden, shares of the rest become smaller. Sets `share` to the last one, which no ray that is
/// left exceeds.
glm::vec3 FirstBounce::take_brightest(uint32_t number, Rays& rays, float& share) const {
    float whole = 0, hidden = 0;
    glm::vec3 sum(0.0f);
    do {
        whole = hidden = 0;
        for (const Ray& ray : rays) whole += ray.luminance;
        share = whole / kLinesOfSight;
        std::erase_if(rays, [&](const Ray& ray) {
            if (!(ray.luminance > share)) return false;
            if (space_.air.sees(places_[number], places_[clusters_[ray.cluster].face]))
                sum += ray.light;
            else
                hidden += ray.luminance;
            return true;
        });
    } while (hidden > 0.5f * whole);
    return sum;
}

/// Returns the irradiance of a face by these clusters. Those that are not alone are divided into groups of
/// about equal light, neighbours together, and one line of sight decides for each group: where all of it is
/// seen the sum is exact.
glm::vec3 FirstBounce::gather(uint32_t number, Rays& rays) const {
    float group = 0, gathered = 0;  // luminance of a group, and of the present one so far
    glm::vec3 sum = take_brightest(number, rays, group), light(0.0f);
    uint32_t seen = Faces::kNone;
    const auto finish = [&] {
        if (seen != Faces::kNone && space_.air.sees(places_[number], places_[seen])) sum += light;
        light = glm::vec3(0.0f);
        gathered = 0;
        seen = Faces::kNone;
    };
    for (const Ray& ray : rays) {
        light += ray.light;
        gathered += ray.luminance;
        // The cluster in the middle of the group's light.
        if (seen == Faces::kNone && gathered >= 0.5f * group) seen = clusters_[ray.cluster].face;
        if (gathered >= group) finish();
    }
    if (seen == Faces::kNone && !rays.empty()) seen = clusters_[rays.back().cluster].face;
    finish();
    return sum;
}

bool FirstBounce::advance() {
    const size_t all = clusters_.empty() ? 0 : irradiance_.size();
    const size_t end = std::min(all, done_ + kReceiversAtOnce);
    parallel_ranges(end - std::min(done_, end), kReceiversATask, [&](size_t first, size_t last) {
        const auto faces = space_.faces.all();
        const float in_plane = kInPlane * space_.grid().voxel;
        std::array<Receiver, kReceiversTogether> receivers;
        std::array<Rays, kReceiversTogether> outer, inner;
        for (size_t begin = done_ + first; begin < done_ + last; begin += kReceiversTogether) {
            const auto numbers =
                std::span(order_).subspan(begin, std::min(kReceiversTogether, done_ + last - begin));
            for (size_t i = 0; i < numbers.size(); ++i) {
                const Face& face = faces[numbers[i]];
                receivers[i] = {face.position, face.normal, face.voxel};
                outer[i].clear();
                inner[i].clear();
            }
            const auto together = std::span(receivers).first(numbers.size());
            look(clusters_, 0, outer_clusters_, together, in_plane, outer);
            look(clusters_, outer_clusters_, clusters_.size(), together, in_plane, inner);
            for (size_t i = 0; i < numbers.size(); ++i) {
                const uint32_t face = numbers[i];
                finish_nearby(receivers[i], outer[i]);
                finish_nearby(receivers[i], inner[i]);
                if (apart_[face] != 0) {
                    from_outside_[face] = gather(face, outer[i]);
                    irradiance_[face] = from_outside_[face] + gather(face, inner[i]);
                } else {
                    outer[i].insert(outer[i].end(), inner[i].begin(), inner[i].end());
                    irradiance_[face] = gather(face, outer[i]);
                }
            }
        }
    });
    done_ = end;
    return done_ < all;
}

}  // namespace lucarne::gi::volume
