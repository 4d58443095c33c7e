#include "gi/engines/paths/interpolation.h"

#include <algorithm>
#include <limits>

namespace lucarne::gi::paths {
namespace {

/// Normals of pixels are noisier than those of gathering points: up to 35 degrees count.
constexpr float kPixelTurn = 0.42525f;  // root of 1 - cos
/// Pixels with less weight than this in all take the nearest point.
constexpr float kLeastSum = 1e-3f;

}  // namespace

glm::vec3 irradiance_at(const PathsBake& bake, std::span<const glm::vec3> irradiance,
                        const glm::vec3& position, const glm::vec3& normal, bool& alone) {
    glm::vec3 sum(0.0f);
    float weights = 0;
    bake.near.visit(position, [&](uint32_t i) {
        const GatheringPoint& point = bake.paths.points[i];
        const float weight = 1 - error_of(point, kPixelReach * point.reach, kPixelTurn, position, normal);
        if (!(weight > 0)) return;
        sum += weight * irradiance[i];
        weights += weight;
    });
    alone = !(weights > kLeastSum);
    if (!alone) return sum / weights;
    float least = std::numeric_limits<float>::infinity();
    glm::vec3 nearest(0.0f);
    bake.far.visit(position, [&](uint32_t i) {
        const GatheringPoint& point = bake.paths.points[i];
        if (glm::dot(normal, point.normal) <= 0) return;
        const float error = error_of(point, point.reach, kPixelTurn, position, normal);
        if (error >= least) return;
        least = error;
        nearest = irradiance[i];
    });
    return nearest;
}

}  // namespace lucarne::gi::paths
