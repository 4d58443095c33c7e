#include "gi/surfels/cut_nodes.h"

#include <algorithm>
#include <cassert>

namespace lucarne::gi {
namespace {

[[maybe_unused]] bool sorted(std::span<const CutNode> nodes) {
    return std::ranges::is_sorted(nodes, {}, &CutNode::node);
}

}  // namespace

NodeChanges node_changes(std::span<const CutNode> before, std::span<const CutNode> now) {
    assert(sorted(before) && sorted(now));
    NodeChanges changes;
    auto was = before.begin();
    for (const CutNode& node : now) {
        for (; was != before.end() && was->node < node.node; ++was) changes.removed.push_back(was->node);
        if (was == before.end() || was->node != node.node)
            changes.added.push_back(node.node);
        else if (!(*was++ == node))
            changes.replaced.push_back(node.node);
    }
    for (; was != before.end(); ++was) changes.removed.push_back(was->node);
    return changes;
}

}  // namespace lucarne::gi
