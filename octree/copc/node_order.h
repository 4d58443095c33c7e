#pragma once

#include <span>
#include <vector>

#include "octree/tree/key.h"

namespace lucarne::octree {

/// Returns the order of a node's points, given by their places, in which every prefix is an even sample of
/// the node (sampler.h). The order is computed as for the root of a build, because the points that the
/// ancestors show are not known here. Places outside the node's cube count as on its border.
std::vector<uint32_t> even_order(const NodeKey& node, std::span<const Place> places);

}  // namespace lucarne::octree
