#pragma once

#include <cstdint>
#include <span>
#include <vector>

namespace lucarne::gi {

/// A node that a cut draws. `content` is equal for equal surfels at equal places with equal areas.
struct CutNode {
    uint32_t node = 0;
    uint64_t content = 0;
    bool operator==(const CutNode&) const = default;
};

/// The nodes of a cut that differ from the nodes before; sorted.
struct NodeChanges {
    std::vector<uint32_t> added, removed;
    std::vector<uint32_t> replaced;  ///< drawn before and now, with other surfels
    bool empty() const { return added.empty() && removed.empty() && replaced.empty(); }
};

/// Compares two lists that are sorted by node.
NodeChanges node_changes(std::span<const CutNode> before, std::span<const CutNode> now);

}  // namespace lucarne::gi
