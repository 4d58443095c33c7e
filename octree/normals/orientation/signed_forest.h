#pragma once

#include <algorithm>
#include <cmath>
#include <cstdint>
#include <unordered_map>
#include <utility>
#include <vector>

namespace lucarne::octree {

/// A union-find whose links carry a sign. It tells which nodes are connected, and whether they have the same
/// or the opposite orientation.
class SignedForest {
 public:
    explicit SignedForest(uint32_t count) : links_(count) {
        for (uint32_t i = 0; i < count; ++i) links_[i] = {i, false};
    }
    struct Root {
        uint32_t node;
        bool opposite;  ///< relative to the node asked for
    };
    Root find(uint32_t node) {
        bool opposite = false;
        while (links_[node].parent != node) {
            Link& link = links_[node];
            const Link above = links_[link.parent];
            // Path halving: links the node to its grandparent.
            link = {above.parent, link.opposite != above.opposite};
            opposite = opposite != link.opposite;
            node = link.parent;
        }
        return {node, opposite};
    }
    void prefetch(uint32_t node) const { __builtin_prefetch(&links_[node], 1); }
    /// Joins the two sets so that `a` and `b` have the same or the opposite orientation. Returns false if
    /// they were in one set. The root of the smaller number stays root.
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

/// Collects weak votes on the relative orientation of pairs of nodes, and joins the nodes by them.
class SignVotes {
 public:
    /// `weight` must be positive.
    void add(uint32_t a, uint32_t b, bool opposite, double weight) { add(a, b, opposite ? -weight : weight); }
    /// `same` is positive for the same orientation, negative for the opposite one.
    void add(uint32_t a, uint32_t b, double same) { votes_[key(a, b)] += same; }
    /// Calls use(a, b) for each pair that has votes.
    template <class Use>
    void each(const Use& use) const {
        for (const auto& [pair, vote] : votes_)
            use(static_cast<uint32_t>(pair >> 32), static_cast<uint32_t>(pair));
    }
    /// Joins nodes by their votes, along the maximum spanning forest, strongest votes first. Then checks each
    /// link against all votes between the two sides that it joins, because one false link between two halves
    /// of a room turns one of them inside out. `rounds`: how many forests are tried, each along the votes
    /// that agree after the one before.
    void unite(SignedForest& forest, unsigned rounds = 1) const;

 private:
    static uint64_t key(uint32_t a, uint32_t b) {
        return static_cast<uint64_t>(std::min(a, b)) << 32 | std::max(a, b);
    }
    std::unordered_map<uint64_t, double> votes_;
};

}  // namespace lucarne::octree
