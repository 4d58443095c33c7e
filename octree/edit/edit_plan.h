#pragma once

#include <span>
#include <vector>

#include "octree/convert/chunks/chunk_plan.h"
#include "octree/tree/source.h"

namespace lucarne::octree {

/// Returns the cube that contains `root` and the box: `root`, doubled toward the box as often as necessary.
/// Errors: too far away.
Result<Cube> grown_root(const Cube& root, const glm::dvec3& min, const glm::dvec3& max);

/// Maps the nodes of an old tree to one whose root cube has grown.
class Shift {
 public:
    Shift(const Cube& before, const Cube& after);
    uint32_t levels() const { return levels_; }
    /// The old root.
    NodeKey root() const { return {levels_, cell_[0], cell_[1], cell_[2]}; }
    NodeKey operator()(const NodeKey& key) const {
        return {key.level + levels_, cell_[0] << key.level | key.x, cell_[1] << key.level | key.y,
                cell_[2] << key.level | key.z};
    }

 private:
    uint32_t levels_;
    std::array<uint32_t, 3> cell_{};
};

/// How an update changes a tree: a few cubes are built again, nodes beside them stay in the file, and only
/// the nodes above both are made again.
struct EditPlan {
    struct Item {
        NodeKey key;              ///< in the new tree
        uint32_t node = kNoNode;  ///< the old node at that key
    };
    std::vector<Item> rebuilt;  ///< cubes whose points are all built again; in Morton order
    std::vector<Item> kept;     ///< nodes with no change in their subtrees; in Morton order
    std::vector<uint32_t> top;  ///< old nodes above both
};

struct EditLimits {
    uint64_t chunk_points = 0;  ///< most points of a cube that is built at once
    size_t leaf = 0;            ///< a cube with at most this many points is one node
    size_t most = 0;            ///< most cubes
};

/// Plans an update. `changed`: how many points are added or removed, by the deepest old node that contains
/// them. Rebuilt cubes are as small as `limits.most` allows. Errors: too many cubes even so.
Result<EditPlan> plan_edit(NodeTable nodes, const Shift& shift, std::span<const uint64_t> changed,
                           uint64_t points, const EditLimits& limits);

}  // namespace lucarne::octree
