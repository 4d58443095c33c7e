#pragma once

#include <span>
#include <vector>

#include "octree/tree/key.h"

namespace lucarne::octree {

/// The order of a node's points, given by their places, in which every prefix is an even sample of the node
/// (sampler.h): as for the root of a build, since what the ancestors show is not at hand. Places outside the
/// node's cube count as on its border.
std::vector<uint32_t> even_order(const NodeKey& node, std::span<const Place> places);

}  // namespace lucarne::octree
