#include "gi/engines/paths/seen_points.h"

#include <algorithm>
#include <limits>
#include <utility>

#include "gi/shared/luminance.h"

namespace lucarne::gi::paths {
namespace {

/// Points disagree if one has less than this share of the light of another.
constexpr float kAlikeLight = 0.6f;
/// How many points are tried for a place that sees none of its own; the root of 1 - cos of the largest turn
/// of their normals.
constexpr size_t kMostTried = 24;
constexpr float kTriedTurn = 1.0f;

}  // namespace

glm::vec3 start_of_rays(const tracing::SurfelTracer& tracer, const SurfacePoint& place) {
    const glm::vec3 above = tracing::offset_origin(place.position, place.normal, place.radius);
    return tracing::before_what_hides(tracer, above, place.viewer, place.normal, place.radius);
}

SeenPoints::SeenPoints(const tracing::SurfelTracer& tracer, const PathsBake& bake, const glm::vec3& offset,
                       std::span<const glm::vec3> irradiance)
    : tracer_(tracer), bake_(bake), offset_(offset), irradiance_(irradiance) {
    facing_.reserve(bake.paths.points.size());
    for (const GatheringPoint& point : bake.paths.points)
        facing_.push_back({point.position, 1 / (point.reach * point.reach), point.normal});
}

bool SeenPoints::disagree(std::span<const PointShare> about) const {
    float least = std::numeric_limits<float>::infinity(), most = 0;
    for (const PointShare& share : about) {
        const float light = luminance(irradiance_[share.point]);
        least = std::min(least, light);
        most = std::max(most, light);
    }
    return least < kAlikeLight * most;
}

bool SeenPoints::sees(const glm::vec3& start, const GatheringPoint& point) const {
    return !tracer_.occluded(start,
                             tracing::offset_origin(point.position + offset_, point.normal, point.radius));
}

void SeenPoints::find_nearest(const SurfacePoint& place, const glm::vec3& start,
                              std::vector<PointShare>& seen) const {
    const glm::vec3 position = place.position - offset_;
    // The nearest ones so far; the farthest of them is the first.
    std::vector<std::pair<float, uint32_t>> tried;
    tried.reserve(kMostTried);
    bake_.far.visit(position, [&](uint32_t i) {
        const Facing& point = facing_[i];
        const float cosine = glm::dot(place.normal, point.normal);
        if (!(cosine > 0)) return;
        const glm::vec3 away = position - point.position;
        const float across = glm::dot(away, point.normal);
        const float distance2 = glm::dot(away, away) + (kAcross * kAcross - 1) * across * across;
        const std::pair error(
            std::max(distance2 * point.per_reach2, (1 - cosine) / (kTriedTurn * kTriedTurn)), i);
        if (tried.size() == kMostTried) {
            if (!(error < tried.front())) return;
            std::ranges::pop_heap(tried);
            tried.pop_back();
        }
        tried.push_back(error);
        std::ranges::push_heap(tried);
    });
    std::ranges::sort_heap(tried);
    for (const auto& [error, i] : tried) {
        if (!sees(start, bake_.paths.points[i])) continue;
        seen.assign(1, {i, 1.0f});
        return;
    }
}

std::span<const PointShare> SeenPoints::about(const SurfacePoint& place, const glm::vec3& start,
                                              std::span<const PointShare> about,
                                              std::vector<PointShare>& seen) const {
    seen.clear();
    if (about.empty()) return about;
    const auto most = std::ranges::max_element(about, {}, &PointShare::share);
    if (!disagree(about) && sees(start, bake_.paths.points[most->point])) return about;
    float sum = 0;
    for (const PointShare& share : about) {
        if (!sees(start, bake_.paths.points[share.point])) continue;
        seen.push_back(share);
        sum += share.share;
    }
    if (seen.size() == about.size()) return about;
    for (PointShare& share : seen) share.share /= sum;
    if (seen.empty()) find_nearest(place, start, seen);
    return seen.empty() ? about : std::span<const PointShare>(seen);
}

}  // namespace lucarne::gi::paths
