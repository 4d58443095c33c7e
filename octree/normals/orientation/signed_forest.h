#pragma once

#include <algorithm>
#include <cmath>
#include <cstdint>
#include <unordered_map>
#include <utility>
#include <vector>

namespace lucarne::octree {

/// Union-find whose links carry a sign: who belongs together, and whether turned the same way or opposite.
class SignedForest {
 public:
    explicit SignedForest(uint32_t count) : links_(count) {
        for (uint32_t i = 0; i < count; ++i) links_[i] = {i, false};
    }
    struct Root {
        uint32_t node;
        bool opposite;  ///< to the node asked for
    };
    Root find(uint32_t node) {
        bool opposite = false;
        while (links_[node].parent != node) {
            Link& link = links_[node];
            const Link above = links_[link.parent];
            // Path halving: hang the node below its grandparent.
            link = {above.parent, link.opposite != above.opposite};
            opposite = opposite != link.opposite;
            node = link.parent;
        }
        return {node, opposite};
    }
    /// Joins the two sets so that `a` and `b` are turned the same way, or opposite; false if they were one
    /// set. The smaller root stays root.
    bool unite(uint32_t a, uint32_t b, bool opposite) {
        Root of_a = find(a), of_b = find(b);
        if (of_a.node == of_b.node) return false;
        if (of_a.node > of_b.node) std::swap(of_a, of_b);
        links_[of_b.node] = {of_a.node, opposite != (of_a.opposite != of_b.opposite)};
        return true;
    }

 private:
    struct Link {
        uint32_t parent : 31;
        bool opposite : 1;
        Link(uint32_t p = 0, bool o = false) : parent(p), opposite(o) {}
    };
    std::vector<Link> links_;
};

/// Votes of many weak witnesses on how pairs of nodes are turned, and what follows from them all.
class SignVotes {
 public:
    /// `weight` > 0.
    void add(uint32_t a, uint32_t b, bool opposite, double weight) {
        votes_[key(a, b)] += opposite ? -weight : weight;
    }
    /// Joins nodes by their votes: along the maximum spanning forest, the clearest first; then each link is
    /// asked whether all votes between the two sides that it joins say the same, as one false link between
    /// two halves of a room turns one of them inside out.
    void unite(SignedForest& forest) const;

 private:
    static uint64_t key(uint32_t a, uint32_t b) {
        return static_cast<uint64_t>(std::min(a, b)) << 32 | std::max(a, b);
    }
    std::unordered_map<uint64_t, double> votes_;
};

}  // namespace lucarne::octree
