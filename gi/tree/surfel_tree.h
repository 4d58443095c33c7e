#pragma once

#include <array>
#include <cstddef>
#include <cstdint>
#include <span>
#include <vector>

#include <glm/vec3.hpp>

#include "gi/shared/flat_surfel.h"
#include "gi/surfels/side_light.h"
#include "gi/tree/wide_node.h"
#include "io/core/parallel.h"

namespace lucarne::gi {

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

inline glm::vec3 middle_of(const WideNode& node, size_t k) {
    return {node.x[k], node.y[k], node.z[k]};
}
inline glm::vec3 axis_of(const WideNode& node, size_t k) {
    return {node.nx[k], node.ny[k], node.nz[k]};
}

/// Calls body(slot) for the children of a slot.
template <class Body>
void for_each_child(const SurfelTree& tree, size_t slot, const Body& body) {
    const int child = tree.nodes[slot / 8].child[slot % 8];
    if (child < 0) return;
    const auto below = static_cast<size_t>(child);
    for (size_t k = 0; k < 8; ++k)
        if (tree.nodes[below].child[k] != kNoChild) body(8 * below + k);
}

template <class Body>
void for_level(const SurfelTree& tree, size_t level, const Body& body) {
    constexpr size_t kNodesATask = 1024;
    const size_t begin = tree.levels[level], end = tree.levels[level + 1];
    parallel_ranges(end - begin, kNodesATask, [&](size_t first, size_t last) {
        for (size_t i = begin + first; i < begin + last; ++i) body(i);
    });
}
/// Calls body(node) for all nodes, those of a level in parallel: the deepest level first, or the root first.
template <class Body>
void for_each_upward(const SurfelTree& tree, const Body& body) {
    for (size_t level = tree.empty() ? 0 : tree.levels.size() - 1; level-- > 0;) for_level(tree, level, body);
}
template <class Body>
void for_each_downward(const SurfelTree& tree, const Body& body) {
    for (size_t level = 0; !tree.empty() && level + 1 < tree.levels.size(); ++level)
        for_level(tree, level, body);
}

/// How much a child counts on the two sides of its parent, and whether its own front is on the parent's
/// front.
struct Facing {
    float front, back;
    bool same;
};
/// Of surfels above each other those on the outside count most: a wall that was scanned from two rooms is one
/// node from afar, and what faces its inside is not seen.
Facing facing(const SurfelTree& tree, size_t parent, size_t child);

/// Computes the light of every slot from that of the surfels (`light`, by surfel). A node's side shines with
/// the mean of its surfels' light, weighted by area and by how much they face that side. See
/// facing().
std::vector<SideLight> pull_light(const SurfelTree& tree, std::span<const SideLight> light);

}  // namespace lucarne::gi
