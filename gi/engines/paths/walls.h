#pragma once

#include <algorithm>
#include <array>
#include <cmath>
#include <cstddef>

#include <glm/common.hpp>
#include <glm/geometric.hpp>
#include <glm/vec3.hpp>

#include "gi/engines/paths/cosine_rays.h"
#include "gi/engines/paths/sides.h"
#include "gi/tracing/surfel_tracer.h"

namespace lucarne::gi::paths {

/// What stands on the surface about a place and cuts it off from what lies behind: in each eighth of the
/// directions along the surface the plane of the first surface across it. Discs stick out through the
/// surfaces at which theirs ends, so the rim of one that is lit from outside is seen in a room, and the other
/// way round.
class Walls {
 public:
    /// Of the eighths: a normal away from the place over the distance of the plane, 1/m; 0: there is none.
    static constexpr size_t kEighths = 8;
    std::array<glm::vec3, kEighths> planes{};

    /// Whether a place this far from the walls' own is behind one. `normal`: of the walls' own place.
    bool hide(const glm::vec3& offset, const glm::vec3& normal) const {
        return glm::dot(planes[eighth_of(offset, normal)], offset) > 1;
    }
    bool are_finite() const {
        return std::ranges::all_of(planes, [](const glm::vec3& p) { return std::isfinite(p.x + p.y + p.z); });
    }
    bool operator==(const Walls&) const = default;

 private:
    /// Counts along the two axes to which the normal is not nearest.
    static size_t eighth_of(const glm::vec3& offset, const glm::vec3& normal) {
        const auto axis = static_cast<int>(facing_of(normal) / 2);
        const float u = offset[(axis + 1) % 3], v = offset[(axis + 2) % 3];
        return (u < 0 ? 1u : 0u) | (v < 0 ? 2u : 0u) | (std::abs(u) < std::abs(v) ? 4u : 0u);
    }
};

/// Finds the walls about a place, up to a distance, m, by a ray along the surface in each eighth. Surfaces
/// that turn by less than 60 degrees from the place's own are parts of it: curved ones, and noise.
Walls find_walls(const tracing::SurfelTracer& tracer, const RayStart& start, float distance);

}  // namespace lucarne::gi::paths
