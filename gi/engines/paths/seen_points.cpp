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
    std::vector<std::pair<float, uint32_t>> tried;
    bake_.far.visit(position, [&](uint32_t i) {
        const GatheringPoint& point = bake_.paths.points[i];
        if (glm::dot(place.normal, point.normal) > 0)
            tried.emplace_back(squared_error_of(point, point.reach, kTriedTurn, position, place.normal), i);
    });
    const size_t count = std::min(tried.size(), kMostTried);
    std::partial_sort(tried.begin(), tried.begin() + static_cast<std::ptrdiff_t>(count), tried.end());
    for (size_t i = 0; i < count && seen.empty(); ++i)
        if (sees(start, bake_.paths.points[tried[i].second])) seen.push_back({tried[i].second, 1.0f});
}

std::span<const PointShare> SeenPoints::about(const SurfacePoint& place, std::span<const PointShare> about,
                                              std::vector<PointShare>& seen) const {
    seen.clear();
    if (about.empty()) return about;
    const glm::vec3 above = tracing::offset_origin(place.position, place.normal, place.radius);
    const glm::vec3 start = tracing::before_what_hides(tracer_, above, place.viewer, place.radius);
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
