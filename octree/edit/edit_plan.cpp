#include "octree/edit/edit_plan.h"

#include <cmath>

#include <fmt/format.h>

namespace lucarne::octree {
namespace {

constexpr uint32_t kMostDoublings = 20;  // as many as metadata may have
/// A cube is built as a whole if at least one point in this many changes, otherwise its children are
/// examined. The first value that gives few enough cubes is used.
constexpr std::array<uint64_t, 3> kWorthwhile = {8, 64, UINT64_MAX};

class Planner {
 public:
    Planner(NodeTable nodes, const Shift& shift, std::span<const uint64_t> changed, const EditLimits& limits,
            uint64_t worthwhile)
        : nodes_(nodes),
          shift_(shift),
          limits_(limits),
          worthwhile_(worthwhile),
          below_(changed.begin(), changed.end()),
          deepest_(nodes.size()) {
        for (size_t i = nodes.size(); i-- > 0;) {
            deepest_[i] = std::max(deepest_[i], nodes[i].key.level);
            if (i == 0) break;
            below_[nodes[i].parent] += below_[i];
            deepest_[nodes[i].parent] = std::max(deepest_[nodes[i].parent], deepest_[i]);
        }
    }

    /// Handles the levels from the new root down to the old one, where there are no nodes yet.
    void above(const NodeKey& key) {
        const NodeKey old = shift_.root();
        if (key.level == old.level) return key == old ? visit(0) : plan_.rebuilt.push_back({key, kNoNode});
        const uint32_t levels = old.level - key.level;
        if (old.x >> levels != key.x || old.y >> levels != key.y || old.z >> levels != key.z)
            return plan_.rebuilt.push_back({key, kNoNode});
        for (uint32_t octant = 0; octant < 8; ++octant) above(key.child(octant));
    }

    size_t cubes() const { return plan_.rebuilt.size() + plan_.kept.size(); }
    EditPlan take() { return std::move(plan_); }

 private:
    void visit(uint32_t index) {
        const NodeInfo& node = nodes_[index];
        const NodeKey key = shift_(node.key);
        const uint64_t changes = below_[index];
        // Nodes whose level would exceed kMostLevel in the grown tree are built again, from higher up.
        const bool sinks = deepest_[index] + shift_.levels() > kMostLevel;
        if (changes == 0 && !sinks) return plan_.kept.push_back({key, index});
        const uint64_t points = node.subtree_count;
        const bool worthwhile = changes >= points / worthwhile_ && points + changes <= limits_.chunk_points;
        const bool collapses = points <= changes + limits_.leaf && points <= limits_.chunk_points;
        if (node.child_mask == 0 || key.level >= kMaxLevel || worthwhile || collapses)
            return plan_.rebuilt.push_back({key, index});
        plan_.top.push_back(index);
        for (uint32_t octant = 0; octant < 8; ++octant) {
            if (const uint32_t child = node.child(octant); child != kNoNode)
                visit(child);
            else
                plan_.rebuilt.push_back({key.child(octant), kNoNode});
        }
    }

    NodeTable nodes_;
    const Shift& shift_;
    const EditLimits& limits_;
    uint64_t worthwhile_;
    std::vector<uint64_t> below_;    ///< changes in the node and its descendants
    std::vector<uint32_t> deepest_;  ///< deepest level in the node's subtree
    EditPlan plan_;
};

}  // namespace

Result<Cube> grown_root(const Cube& root, const glm::dvec3& min, const glm::dvec3& max) {
    Cube cube = root;
    if (cube.doublings == 0) cube.first_min = cube.min;
    const double scale = 0x1p32 / cube.first_size();
    const auto lattice = [&](const glm::dvec3& p, int axis) {
        return std::floor((p[axis] - cube.first_min[axis]) * scale * 0x1p-32);  // in edges of the first cube
    };
    for (;;) {
        const auto edge = static_cast<double>(uint64_t{1} << cube.doublings);
        bool inside = true;
        std::array<bool, 3> down{};
        for (int axis = 0; axis < 3; ++axis) {
            const auto cell = static_cast<double>(cube.first_cell[static_cast<size_t>(axis)]);
            down[static_cast<size_t>(axis)] = lattice(min, axis) + cell < 0;
            inside = inside && !down[static_cast<size_t>(axis)] && lattice(max, axis) + cell < edge;
        }
        if (inside) return cube.doublings == 0 ? root : cube;
        if (cube.doublings == kMostDoublings)
            return rejected("points", "are too far from those of the cache for a common tree",
                            "convert all scans together");
        for (size_t axis = 0; axis < 3; ++axis) {
            if (!down[axis]) continue;
            cube.min[static_cast<int>(axis)] -= cube.size;
            cube.first_cell[axis] += 1u << cube.doublings;
        }
        cube.size *= 2;
        ++cube.doublings;
    }
}

Shift::Shift(const Cube& before, const Cube& after) : levels_(after.doublings - before.doublings) {
    for (size_t axis = 0; axis < 3; ++axis)
        cell_[axis] = (after.first_cell[axis] - before.first_cell[axis]) >> before.doublings;
}

Result<EditPlan> plan_edit(NodeTable nodes, const Shift& shift, std::span<const uint64_t> changed,
                           uint64_t points, const EditLimits& limits) {
    if (points <= limits.leaf) return EditPlan{{{NodeKey{}, 0}}, {}, {}};
    for (const uint64_t worthwhile : kWorthwhile) {
        Planner planner(nodes, shift, changed, limits, worthwhile);
        planner.above({});
        if (planner.cubes() <= limits.most) return planner.take();
    }
    return bad_arguments("--memory", "is too little for changes in so many places at once",
                         "give more, or convert all scans together");
}

}  // namespace lucarne::octree
