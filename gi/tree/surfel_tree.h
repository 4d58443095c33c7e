#pragma once

#include <array>
#include <cstddef>
#include <cstdint>
#include <span>
#include <vector>

#include <glm/vec3.hpp>

#include "gi/shared/flat_surfel.h"
#include "gi/tree/wide_node.h"

namespace lucarne::gi {

/// Light that leaves a surfel or a node: radiance, W/(sr m^2), of its front (the side of its axis) and of its
/// back.
struct SideLight {
    glm::vec3 front{0.0f}, back{0.0f};
};

/// A tree over the discs of surfels with up to eight children a node. Its nodes are ranges of the Morton
/// order, in order of their level: parents stand before their children.
struct SurfelTree {
    std::vector<WideNode> nodes;
    std::vector<uint32_t> surfels;  ///< by slot: the surfel of a leaf; kNoSurfel for other slots
    std::vector<float> areas;       ///< by slot, m^2
    std::vector<size_t> levels;     ///< the first node of each level, and nodes.size()
    size_t leaves = 0;

    bool empty() const { return nodes.empty(); }
};

/// Returns a node without children.
WideNode empty_node();

/// Builds the tree over those surfels that have a disc: a finite position and normal, and a radius over
/// zero. The same surfels give the same tree, whatever the number of threads. A surfel without an area stands
/// for that of its disc.
SurfelTree build_tree(std::span<const FlatSurfel> surfels);

/// Computes the light of every slot from that of the surfels (`light`, by surfel). A node's side shines with
/// the mean of its surfels' light, weighted by area and by how much they face that side. Of surfels above
/// each other those on the outside count most: a wall that was scanned from two rooms is one node from afar,
/// and what faces its inside is not seen.
void pull_light(const SurfelTree& tree, std::span<const SideLight> light, std::vector<SideLight>& slots);

}  // namespace lucarne::gi
