#pragma once

#include <span>
#include <vector>

#include "octree/tree/source.h"

namespace lucarne::octree {

/// Sets the area floors of nodes that are linked and have their counts, from `codes`: the Morton codes,
/// sorted, of the points of some of the topmost nodes.
///
/// A node's surface S is what the codes in its cube show of it, by the cells they fill, where they are many
/// enough, else the part of its parent's that is its part of the points below. With r the points on a unit of
/// surface that the ancestors show, the node's n points make it r + n / S, and a point of unknown area stands
/// for the inverse (octree/tree/footprint.h), at a prefix of a share s for 1 / (r + s n / S).
void set_area_floors(std::span<NodeInfo> nodes, std::span<const uint64_t> codes, double root_size);

}  // namespace lucarne::octree
