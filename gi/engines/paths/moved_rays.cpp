#include "gi/engines/paths/moved_rays.h"

#include <algorithm>
#include <cmath>
#include <utility>

#include <glm/geometric.hpp>

#include "gi/engines/paths/cosine_rays.h"
#include "gi/shared/luminance.h"
#include "gi/tracing/light_sampling.h"

namespace lucarne::gi::paths {
namespace {

/// Rays that leave the scene meet something so many m away.
constexpr float kFar = 1e4f;
constexpr float kGrazing = 0.05f;
/// A ray counts at most so many times as much as at its point: what is near has been met by few.
constexpr float kMostTimes = 20;
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
/// Rays that are kept, of 32 bytes each: 64 MB.
constexpr size_t kMostRays = size_t{1} << 21;

}  // namespace

MovedRays::MovedRays(std::shared_ptr<const PathsBake> bake)
    : bake_(std::move(bake)), kept_(std::make_unique<Kept[]>(bake_->paths.points.size())) {}

void MovedRays::set(std::span<const glm::vec3> radiosity) {
    light_.clear();
    light_.reserve(radiosity.size() + 1);
    for (const glm::vec3& light : radiosity) light_.push_back(luminance(light));
    light_.push_back(0);
}

/// Finds what the rays of a point met, by the planes of the groups that they name.
std::vector<MovedRays::Ray> MovedRays::make_rays(const GatheringPoint& point,
                                                 std::span<const uint32_t> groups) const {
    const Groups& all = bake_->paths.groups;
    const glm::vec3 start = tracing::offset_origin(point.position, point.normal, point.radius);
    std::vector<Ray> rays(groups.size());
    for (uint32_t i = 0; i < rays.size(); ++i) {
        const glm::vec3 direction = cosine_direction(point.normal, even_point(i, bake_->seed, point.side));
        const uint32_t group = groups[i];
        float distance = kFar;
        glm::vec3 normal = -direction;
        if (group != kNone) {
            const GroupPlane& plane = bake_->planes[group];
            const float cosine = -glm::dot(direction, plane.normal);
            const float to_middle = glm::dot(plane.centre - start, direction);
            distance = cosine > kGrazing ? glm::dot(start - plane.centre, plane.normal) / cosine : to_middle;
            distance = std::max(
                std::clamp(distance, to_middle - all.cell[group], to_middle + all.cell[group]), point.radius);
            normal = plane.normal;
        }
        const float from = std::max(glm::dot(direction, point.normal), kGrazing),
                    to = std::max(-glm::dot(direction, normal), kGrazing);
        rays[i] = {start + direction * distance,
                   (distance * distance + point.radius * point.radius) / (from * to), normal,
                   std::min(group, all.count())};
    }
    return rays;
}

std::span<const MovedRays::Ray> MovedRays::rays_of(uint32_t point, std::vector<Ray>& own) const {
    const LightPaths& paths = bake_->paths;
    const auto make = [&] {
        return make_rays(
            paths.points[point],
            std::span(paths.rays).subspan(size_t{point} * paths.rays_a_point, paths.rays_a_point));
    };
    std::call_once(kept_[point].once, [&] {
        if (count_.fetch_add(paths.rays_a_point) < kMostRays) kept_[point].rays = make();
    });
    if (!kept_[point].rays.empty()) return kept_[point].rays;
    own = make();
    return own;
}

float MovedRays::factor(const SurfacePoint& place, const glm::vec3& offset,
                        std::span<const PointShare> about) const {
    const glm::vec3 at = tracing::offset_origin(place.position, place.normal, place.radius) - offset;
    float there = 0, here = 0;
    std::vector<Ray> own;
    for (const PointShare& share : about) {
        const float radius2 = std::pow(bake_->paths.points[share.point].radius, 2.0f);
        float sum = 0, times = 0, unmoved = 0;
        const std::span<const Ray> rays = rays_of(share.point, own);
        for (const Ray& ray : rays) {
            const glm::vec3 away = ray.place - at;
            const float distance2 = glm::dot(away, away);
            const float cosines =
                std::max(glm::dot(away, place.normal), 0.0f) * std::max(-glm::dot(away, ray.normal), 0.0f);
            const float time = std::min(
                ray.weight * cosines / std::max(distance2 * (distance2 + radius2), 1e-12f), kMostTimes);
            const float light = light_[ray.group];
            sum += time * light;
            times += time;
            unmoved += light;
        }
        const auto count = static_cast<float>(rays.size());
        here += share.share * unmoved / count;
        there += share.share * light_there(sum / count, times / count, unmoved / count);
    }
    const float times = there / here;  // of a damaged bake file perhaps no number
    return here > 0 && std::isfinite(times) ? times : 1;
}

}  // namespace lucarne::gi::paths
