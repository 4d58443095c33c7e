#include "gi/engines/paths/walls.h"

#include <algorithm>
#include <cstdint>

namespace lucarne::gi::paths {
namespace {

/// The cosine between the normals of a surface and of one that stands on it is smaller.
constexpr float kMostCosine = 0.5f;
/// Surfaces that a ray may cross before it gives up.
constexpr int kMostCrossed = 4;
/// Tangent of 22.5 degrees: the middle of an eighth.
constexpr float kMiddle = 0.41421356f;
/// The least distance of a wall, in radii: a place under a leaning wall is behind its plane.
constexpr float kLeastDistance = 1e-3f;

/// Returns the direction along a surface in the middle of an eighth (Walls::eighth_of).
glm::vec3 direction_of(size_t eighth, const glm::vec3& normal) {
    const auto axis = static_cast<int>(facing_of(normal) / 2);
    const float large = 1, small = kMiddle;
    const float u = (eighth & 4 ? small : large) * (eighth & 1 ? -1.0f : 1.0f);
    const float v = (eighth & 4 ? large : small) * (eighth & 2 ? -1.0f : 1.0f);
    glm::vec3 direction(0.0f);
    direction[(axis + 1) % 3] = u;
    direction[(axis + 2) % 3] = v;
    direction[axis] = -(u * normal[(axis + 1) % 3] + v * normal[(axis + 2) % 3]) / normal[axis];
    return glm::normalize(direction);
}

}  // namespace

Walls find_walls(const tracing::SurfelTracer& tracer, const RayStart& start, float distance) {
    Walls walls;
    const glm::vec3 begin = tracing::offset_origin(start.position, start.normal, start.radius);
    for (size_t eighth = 0; eighth < Walls::kEighths; ++eighth) {
        const glm::vec3 direction = direction_of(eighth, start.normal);
        float gone = 0;
        for (int crossed = 0; crossed < kMostCrossed; ++crossed) {
            const auto hit = tracer.first_hit(begin + direction * gone, direction);
            if (!hit || gone + hit->distance > distance) break;
            const Surfel& surfel = tracer.surfels()[hit->surfel];
            if (std::abs(glm::dot(surfel.normal, start.normal)) < kMostCosine) {
                const glm::vec3 away =
                    glm::dot(surfel.normal, direction) < 0 ? -surfel.normal : surfel.normal;
                walls.planes[eighth] = away / std::max(glm::dot(away, surfel.position - start.position),
                                                       kLeastDistance * start.radius);
                break;
            }
            gone += hit->distance + kLeastDistance * surfel.radius;
        }
    }
    return walls;
}

}  // namespace lucarne::gi::paths
