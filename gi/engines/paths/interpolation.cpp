#include "gi/engines/paths/interpolation.h"

#include <algorithm>
#include <cmath>
#include <limits>

#include "io/core/parallel.h"

namespace lucarne::gi::paths {
namespace {

/// Normals of pixels are noisier than those of gathering points: up to 35 degrees count.
constexpr float kPixelTurn = 0.42525f;  // root of 1 - cos
/// Pixels with less weight than this in all take the nearest point.
constexpr float kLeastSum = 1e-3f;
constexpr size_t kPointsAPiece = 256;

}  // namespace

glm::vec3 irradiance_at(const PathsBake& bake, std::span<const glm::vec3> irradiance,
                        const glm::vec3& position, const glm::vec3& normal, bool& alone) {
    glm::vec3 sum(0.0f);
    float weights = 0;
    bake.near.visit(position, [&](uint32_t i) {
        const GatheringPoint& point = bake.paths.points[i];
        const float error2 = squared_error_of(point, kPixelReach * point.reach, kPixelTurn, position, normal);
        if (error2 >= 1) return;
        const float weight = 1 - std::sqrt(std::max(error2, 0.0f));
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

std::vector<glm::vec3> smooth(const PathsBake& bake, std::span<const glm::vec3> irradiance) {
    std::vector<glm::vec3> smoothed(irradiance.size());
    parallel_ranges(smoothed.size(), kPointsAPiece, [&](size_t begin, size_t end) {
        for (size_t i = begin; i < end; ++i) {
            const GatheringPoint& point = bake.paths.points[i];
            bool alone = false;
            smoothed[i] = irradiance_at(bake, irradiance, point.position, point.normal, alone);
        }
    });
    return smoothed;
}

}  // namespace lucarne::gi::paths
