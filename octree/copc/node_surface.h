#pragma once

#include <span>
#include <vector>

#include "octree/tree/source.h"

namespace lucarne::octree {

/// Sets the area floors of nodes whose links and counts are set. `codes` are the sorted Morton codes of the
/// points of some of the topmost nodes.
///
/// The surface S in a node's cube follows from the cells that the codes there fill, if there are enough
/// codes. Otherwise it is a part of the parent's surface, in proportion to the points below the parent. Let r
/// be the density of the points that the ancestors show, per unit of surface. The node's n points raise it to
/// r + n / S. A point of unknown area represents the inverse of the density (octree/tree/footprint.h): at a
/// prefix of a share s, 1 / (r + s n / S).
void set_area_floors(std::span<NodeInfo> nodes, std::span<const uint64_t> codes, double root_size);

}  // namespace lucarne::octree
