#include "gi/engines/paths/moved_rays.h"

#include <algorithm>
#include <cmath>
#include <utility>

#include <glm/geometric.hpp>

#include "gi/engines/paths/cosine_rays.h"
#include "gi/shared/luminance.h"
#include "gi/tracing/light_sampling.h"
#include "io/core/parallel.h"

namespace lucarne::gi::paths {
namespace {

/// Rays that leave the scene meet something so many m away.
constexpr float kFar = 1e4f;
constexpr float kGrazing = 0.05f;
/// Places at which all rays of a point count less than this in the mean are behind what they met.
constexpr float kLeastMean = 0.05f;

/// Returns the light of a point's rays at another place. `sum`: of what they bring there, over their number;
/// `times`: how often they count there in the mean: what is missing to 1 the place sees, and the point does
/// not; `here`: their light at the point. What is missing has the mean light of the rest, as in even light,
/// but where much is missing no more than the point has: in corners it is dark.
float light_there(float sum, float times, float here) {
    if (times < kLeastMean) return here;
    const float mean = sum / times, met = std::min(times, 1.0f);
    const float rest = met * mean + (1 - met) * std::min(mean, here);
    return std::max(sum + rest * (1 - times), 0.0f);
}
/// How far from walls light is looked for at least, in radii of surfels: pixels in the corner of two walls
/// are that near.
constexpr float kClear = 0.5f;
/// Rays that are kept, of 32 bytes each: 64 MB.
constexpr size_t kMostRays = size_t{1} << 21;
constexpr size_t kPointsATask = 256;

}  // namespace

MovedRays::MovedRays(std::shared_ptr<const PathsBake> bake)
    : bake_(std::move(bake)), kept_(std::make_unique<Kept[]>(bake_->paths.points.size())) {}

void MovedRays::set(std::span<const glm::vec3> radiosity, std::span<const glm::vec3> of_lobes) {
    of_lobes_.clear();
    of_lobes_.reserve(of_lobes.size());
    for (const glm::vec3& light : of_lobes) of_lobes_.push_back(luminance(light));
    light_.clear();
    light_.reserve(radiosity.size() + 1);
    for (const glm::vec3& light : radiosity) light_.push_back(luminance(light));
    light_.push_back(0);
    parallel_ranges(bake_->paths.points.size(), kPointsATask, [&](size_t begin, size_t end) {
        for (size_t i = begin; i < end; ++i)
            if (!kept_[i].rays.blocks.empty()) set_light(static_cast<uint32_t>(i), kept_[i].rays);
    });
}

/// Returns the groups that the rays of a point name.
std::span<const uint32_t> MovedRays::groups_of(uint32_t point) const {
    const LightPaths& paths = bake_->paths;
    return std::span(paths.rays).subspan(size_t{point} * paths.rays_a_point, paths.rays_a_point);
}

/// Finds what the rays of a point met, by the planes of the groups that they name.
void MovedRays::make(uint32_t point, Rays& rays) const {
    constexpr size_t kLanes = native::RayBlock::kRays;
    const GatheringPoint& from = bake_->paths.points[point];
    const std::span<const uint32_t> groups = groups_of(point);
    const std::vector<float>& cells = bake_->paths.groups.cell;
    const glm::vec3 start = tracing::offset_origin(from.position, from.normal, from.radius);
    const CosineDirections directions(from.normal, bake_->seed, from.side);
    rays.blocks.assign((groups.size() + kLanes - 1) / kLanes, {});
    for (uint32_t i = 0; i < groups.size(); ++i) {
        const glm::vec3 direction = directions[i];
        float distance = kFar;
        glm::vec3 normal = -direction;
        if (const uint32_t group = groups[i]; group != kNone) {
            const GroupPlane& plane = bake_->planes[group];
            const float cosine = -glm::dot(direction, plane.normal);
            const float to_middle = glm::dot(plane.centre - start, direction);
            distance = cosine > kGrazing ? glm::dot(start - plane.centre, plane.normal) / cosine : to_middle;
            distance = std::max(std::clamp(distance, to_middle - cells[group], to_middle + cells[group]),
                                from.radius);
            normal = plane.normal;
        }
        const float leaving = std::max(glm::dot(direction, from.normal), kGrazing),
                    arriving = std::max(-glm::dot(direction, normal), kGrazing);
        const glm::vec3 place = start + direction * distance;
        native::RayBlock& block = rays.blocks[i / kLanes];
        const size_t lane = i % kLanes;
        block.x[lane] = place.x;
        block.y[lane] = place.y;
        block.z[lane] = place.z;
        block.normal_x[lane] = normal.x;
        block.normal_y[lane] = normal.y;
        block.normal_z[lane] = normal.z;
        block.weight[lane] = (distance * distance + from.radius * from.radius) / (leaving * arriving);
    }
    set_light(point, rays);
}

void MovedRays::set_light(uint32_t point, Rays& rays) const {
    constexpr size_t kLanes = native::RayBlock::kRays;
    const std::span<const uint32_t> groups = groups_of(point);
    const auto dark = static_cast<uint32_t>(light_.size() - 1);
    float sum = 0;
    for (size_t i = 0; i < groups.size(); ++i) {
        float light = light_[std::min(groups[i], dark)];
        if (!of_lobes_.empty()) light += of_lobes_[size_t{point} * groups.size() + i];
        rays.blocks[i / kLanes].light[i % kLanes] = light;
        sum += light;
    }
    rays.light = sum / static_cast<float>(groups.size());
}

const MovedRays::Rays& MovedRays::rays_of(uint32_t point, Rays& own) const {
    Kept& kept = kept_[point];
    std::call_once(kept.once, [&] {
        if (count_.fetch_add(bake_->paths.rays_a_point) < kMostRays) make(point, kept.rays);
    });
    if (!kept.rays.blocks.empty()) return kept.rays;
    make(point, own);
    return own;
}

/// Returns `at`, or a place kClear radii before the planes of walls that stand on the surface about these
/// points, if it is nearer to them: of a wall in whose plane a place lies no ray brings it anything.
glm::vec3 MovedRays::clear_of_walls(const glm::vec3& at, std::span<const PointShare> about) const {
    glm::vec3 place = at;
    for (const PointShare& share : about) {
        const GatheringPoint& point = bake_->paths.points[share.point];
        for (const glm::vec3& plane : point.walls.planes) {
            const float steepness = glm::length(plane);
            if (!(steepness > 0)) continue;
            const float before = (1 - glm::dot(plane, place - point.position)) / steepness;
            const float wanted = kClear * point.radius;
            if (before < wanted && before > -wanted) place -= plane * ((wanted - before) / steepness);
        }
    }
    return place;
}

float MovedRays::factor(const glm::vec3& place, const glm::vec3& normal,
                        std::span<const PointShare> about) const {
    const glm::vec3 at = clear_of_walls(place, about);
    const auto count = static_cast<float>(bake_->paths.rays_a_point);
    float there = 0, here = 0;
    Rays own;
    for (const PointShare& share : about) {
        const float radius = bake_->paths.points[share.point].radius;
        const Rays& rays = rays_of(share.point, own);
        const native::RaySums sums = native::add_moved(rays.blocks, at, normal, radius * radius);
        here += share.share * rays.light;
        there += share.share * light_there(sums.light / count, sums.times / count, rays.light);
    }
    const float times = there / here;  // of a damaged bake file perhaps no number
    return here > 0 && std::isfinite(times) ? times : 1;
}

}  // namespace lucarne::gi::paths
