#pragma once

#include <glm/vec3.hpp>

#include "octree/normals/neighbours/tile.h"

namespace lucarne::octree {

/// A disc whose size is in doubt.
struct WideDisc {
    glm::vec3 normal{0.0f};  ///< unit
    float radius = 0;        ///< with which it is drawn
    bool sparse = false;     ///< the surface nearby is far denser
    /// Its plane is uncertain, and its points lie in a strip or are sparse: perhaps a sheet of mixed pixels.
    bool doubtful = false;
};

/// How far around a disc its surroundings are looked at, in its radii.
inline constexpr float kEarnedLook = 2.0f;

/// Returns the share of a point whose disc reaches as far as the nearest other point, at a squared distance
/// of `nearest2`: the largest of a point without a surface, such as that of a leaf.
float lone_area(float nearest2);

/// Returns the largest share of the surface that a disc has earned; infinity: any. A disc in a crowd, of many
/// more points than a sheet of discs of its size has there, must lie in the plane of nearly half of them. A
/// sparse point that continues a dense wall does, even in a corner of it. A mixed pixel or a lone point of a
/// wire before dense walls does not, although its own few neighbours have some plane; it gets the share that
/// the points of the crowd have on average, but its disc reaches at most half-way to the nearest point.
/// Around a sparse disc without a crowd, .3 of the points must lie near its plane; else they are scattered in
/// the air, and the same holds. A doubtful disc is in a crowd already where a fifth more points lie than in a
/// sheet, and .6 of them must lie in its plane: a curtain of mixed pixels leads from one thing to another,
/// and most points around it belong to these. `centre` is relative to the tile's origin. `around`: all points
/// within `look`, usually kEarnedLook radii, of it.
float earned_area(const Tile& around, const glm::vec3& centre, float look, const WideDisc& disc);

}  // namespace lucarne::octree
