#pragma once

#include <optional>

#include <glm/vec3.hpp>

#include "octree/normals/beyond.h"
#include "octree/normals/neighbours/tile.h"

namespace lucarne::octree {

/// The line at which the surface of a point at a rim ends.
struct Border {
    glm::vec3 toward{0.0f};           ///< unit, in the tangent plane: to the line, at right angles
    float distance = 0;               ///< of the line, half a spacing beyond the outermost points
    Beyond beyond = Beyond::nothing;  ///< `rises`: the other surface lies where the normal points
};

/// A point at a rim, and what is known around it.
struct Rim {
    TangentFrame frame;
    glm::vec3 outward{0.0f};  ///< unit, in the plane: the middle of the directions without neighbours
    float spacing = 0;        ///< between the surface's points
    float level = 0;          ///< height over the tangent plane up to which points belong to the surface
};

inline constexpr float kBorderLook = 12.0f;

/// Finds the border of a surface near a point: the line with all points of the surface on one side that is
/// nearest to the point, an edge of their convex hull. Only points within some spacings along the border
/// count, so borders may bend. Returns nothing if the line is farther away than a disc reaches, if points on
/// both sides of the plane lie beside it, and at holes. `around`: all points within kBorderLook spacings of
/// the one at `centre` (relative to the tile's origin).
std::optional<Border> find_border(const Tile& around, const glm::vec3& centre, const Rim& rim);

}  // namespace lucarne::octree
