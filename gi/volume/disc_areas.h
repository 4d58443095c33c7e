#pragma once

#include <algorithm>
#include <cmath>

#include <glm/geometric.hpp>
#include <glm/vec3.hpp>

#include "gi/volume/grid.h"
#include "gi/volume/polygon.h"

namespace lucarne::gi::volume {

/// Voxels count as touched by what is nearer than this share of their side, so that walls which lie in the
/// border of two voxels are closed whatever their positions are rounded to.
inline constexpr float kTouching = 1e-3f;

/// An octagon about a disc. Its corners are u + t v, t u + v, and so on, with t = kTangent.
struct Octagon {
    static constexpr float kTangent = 0.41421356f;  ///< of 22.5 degrees: half a side, in radii
    glm::vec3 u, v;                                 ///< to the middles of two sides, at right angles

    Octagon(const glm::vec3& normal, float radius);
    /// Returns how far it reaches along a direction, times the direction's length.
    float reach(const glm::vec3& direction) const {
        const float along = std::abs(glm::dot(direction, u)), across = std::abs(glm::dot(direction, v));
        return std::max(along + kTangent * across, kTangent * along + across);
    }
};

/// Returns the octagon about a disc, in units of the grid's voxels.
Polygon octagon_about(const Grid& grid, const glm::vec3& position, const glm::vec3& normal, float radius);

/// Calls body(cell, part) for every voxel of the grid that a disc touches (an octagon about the disc, which
/// touches a few more), with the part of the octagon inside it, in units of voxels.
template <class Body>
void for_each_voxel(const Grid& grid, const glm::vec3& position, const glm::vec3& normal, float radius,
                    const Body& body) {
    for_each_voxel_of(grid.size, octagon_about(grid, position, normal, radius), kTouching, body);
}

}  // namespace lucarne::gi::volume
