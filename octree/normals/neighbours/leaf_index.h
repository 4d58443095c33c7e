#pragma once

#include "octree/normals/neighbours/point_index.h"

namespace lucarne::octree {

/// Points along a Morton curve, divided at the borders of octree cells into leaves of a few points, and a
/// tree of boxes over the leaves, eight to a node. Besides the points it holds only the boxes: 2 bytes a
/// point. A search visits whole leaves, for all queries of a leaf at once.
class LeafIndex final : public PointIndex {
 public:
    explicit LeafIndex(const PointArrays& points);

    size_t merge_nearest(const glm::dvec3& query, std::span<Neighbour> nearest, size_t found,
                         uint32_t offset) const override;
    bool gather(const Box& box, double radius, uint32_t offset, size_t most, Tile& tile) const override;
    /// The indices at which the leaves begin, ascending, followed by the number of points.
    std::span<const uint32_t> leaves() const { return first_; }

 private:
    static constexpr size_t kFan = kBoxes;
    using Node = Boxes;  ///< bounds of the children
    /// A box of the tree that a search still has to visit: a node of `level`, or a leaf.
    struct Step {
        float distance2;
        uint32_t level, node;
    };
    static constexpr size_t kMostSteps = 12 * kFan;  ///< enough for 8^11 leaves
    void cut(uint32_t first, uint32_t last, std::span<const uint64_t> codes);
    void build_tree();
    Box bounds_of_leaf(size_t leaf) const;

    glm::vec3 relative(const glm::dvec3& p, float outward) const;

    const PointArrays* points_;
    glm::dvec3 centre_{0.0};  ///< boxes are relative to it
    std::vector<uint32_t> first_;
    std::vector<std::vector<Node>> levels_;  ///< the first level is over the leaves, the last is one node
};

}  // namespace lucarne::octree
