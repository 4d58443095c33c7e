#pragma once

#include <vector>

#include "octree/normals/neighbours/neighbours.h"

namespace lucarne::octree {

/// Most points of a group in the air. Larger ones may be things that hang there.
inline constexpr size_t kMostGroup = 40;

/// Whether a site belongs to a small group of points in the air: what a scanner saw of somebody who passed,
/// or of another scanner. All of them are each other's neighbours, so they have a plane and a density like
/// any surface.
struct GroupSearch {
    bool alone = false;
    double radius = 0;  ///< must be known first; 0: the answer is final
};
/// Looks for a gap: at most kMostGroup points, which reach as far as `reach` at least, and no other point up
/// to twice as far as the farthest of them. `reach`: distance of the last of the nearest points, which count
/// as the group. `distances2`: scratch memory.
GroupSearch find_gap(ChunkNeighbours::Surroundings& around, double reach, std::vector<float>& distances2);

}  // namespace lucarne::octree
