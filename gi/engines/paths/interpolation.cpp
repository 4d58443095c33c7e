#include "gi/engines/paths/interpolation.h"

#include <algorithm>
#include <cmath>
#include <limits>

#include "io/core/parallel.h"

namespace lucarne::gi::paths {
namespace {

/// On curved surfaces light changes with the normal, so points whose normals differ by up to 24 degrees count
/// (14 degrees while points share their light, which blurs as well); up to 40 degrees where there are none,
/// as normals of pixels are noisy. Roots of 1 - cos.
constexpr float kTurn = 0.29403f, kSharingTurn = 0.17235f, kWideTurn = 0.48369f;
/// Pixels with less weight than this in all take the nearest point.
constexpr float kLeastSum = 1e-3f;
constexpr size_t kPointsAPiece = 256;

glm::vec3 irradiance_within(const PathsBake& bake, std::span<const glm::vec3> irradiance, float turn,
                            const glm::vec3& position, const glm::vec3& normal, bool& alone) {
    glm::vec3 sum(0.0f), wide_sum(0.0f);
    float weights = 0, wide_weights = 0;
    bake.near.visit(position, [&](uint32_t i) {
        const GatheringPoint& point = bake.paths.points[i];
        const float reach = kPixelReach * point.reach;
        const float wide2 = squared_error_of(point, reach, kWideTurn, position, normal);
        if (wide2 >= 1) return;
        const float wide = 1 - std::sqrt(std::max(wide2, 0.0f));
        wide_sum += wide * irradiance[i];
        wide_weights += wide;
        const float error2 = squared_error_of(point, reach, turn, position, normal);
        if (error2 >= 1) return;
        const float weight = 1 - std::sqrt(std::max(error2, 0.0f));
        sum += weight * irradiance[i];
        weights += weight;
    });
    alone = !(std::max(weights, wide_weights) > kLeastSum);
    if (!alone) return weights > kLeastSum ? sum / weights : wide_sum / wide_weights;
    float least = std::numeric_limits<float>::infinity();
    glm::vec3 nearest(0.0f);
    bake.far.visit(position, [&](uint32_t i) {
        const GatheringPoint& point = bake.paths.points[i];
        if (glm::dot(normal, point.normal) <= 0) return;
        const float error = error_of(point, point.reach, kWideTurn, position, normal);
        if (error >= least) return;
        least = error;
        nearest = irradiance[i];
    });
    return nearest;
}

}  // namespace

glm::vec3 irradiance_at(const PathsBake& bake, std::span<const glm::vec3> irradiance,
                        const glm::vec3& position, const glm::vec3& normal, bool& alone) {
    return irradiance_within(bake, irradiance, kTurn, position, normal, alone);
}

std::vector<glm::vec3> smooth(const PathsBake& bake, std::span<const glm::vec3> irradiance) {
    std::vector<glm::vec3> smoothed(irradiance.size());
    parallel_ranges(smoothed.size(), kPointsAPiece, [&](size_t begin, size_t end) {
        for (size_t i = begin; i < end; ++i) {
            const GatheringPoint& point = bake.paths.points[i];
            bool alone = false;
            smoothed[i] =
                irradiance_within(bake, irradiance, kSharingTurn, point.position, point.normal, alone);
        }
    });
    return smoothed;
}

}  // namespace lucarne::gi::paths
