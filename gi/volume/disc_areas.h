#pragma once

#include <glm/vec3.hpp>

#include "gi/volume/grid.h"
#include "gi/volume/polygon.h"

namespace lucarne::gi::volume {

/// Voxels count as touched by what is nearer than this share of their side, so that walls which lie in the
/// border of two voxels are closed whatever their positions are rounded to.
inline constexpr float kTouching = 1e-3f;

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
