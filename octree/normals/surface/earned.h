#pragma once

#include <glm/vec3.hpp>

#include "octree/normals/neighbours/tile.h"

namespace lucarne::octree {

/// A disc whose size is in doubt.
struct WideDisc {
    glm::vec3 normal{0.0f};  ///< unit
    float radius = 0;        ///< with which it is drawn
};

/// How far around a disc its surroundings are looked at, in its radii.
inline constexpr float kEarnedLook = 2.0f;

/// Returns the largest share of the surface that a disc has earned; infinity: any. A disc in a crowd, of many
/// more points than a sheet of discs of its size has there, must lie in the plane of nearly half of them. A
/// sparse point that continues a dense wall does, even in a corner of it. A mixed pixel or a lone point of a
/// wire before dense walls does not, although its own few neighbours have some plane; it gets the share that
/// the points of the crowd have on average. `around`: all points within kEarnedLook radii of the disc's
/// centre (relative to the tile's origin), or within `known` if that is less.
float earned_area(const Tile& around, const glm::vec3& centre, float known, const WideDisc& disc);

}  // namespace lucarne::octree
