#include "octree/normals/orientation/signed_forest.h"

namespace lucarne::octree {
namespace {

/// Limit on the votes and nodes that are checked again in all rounds together, so that no cloud takes more
/// than a second or two.
constexpr double kMostWork = 3e8;
constexpr double kAgainst = -1e-6;  ///< sums below this contradict a link; smaller magnitudes are rounding

struct Vote {
    uint32_t a, b;
    double same;        ///< > 0: same orientation
    uint32_t meet = 0;  ///< where the paths from a and b to the root meet
};

/// The nodes that votes join, and their orientation: a spanning forest, and a sign for each node.
class Ballot {
 public:
    Ballot(uint32_t nodes, std::vector<Vote> votes) : votes_(std::move(votes)), nodes_(nodes) { build(); }

    /// Builds the forest: strongest votes first, those that agree with the present signs before the others.
    /// Nodes without a sign get theirs along it.
    void build() {
        const auto kept = [&](const Vote& vote) {
            const int signs = nodes_[vote.a].sign * nodes_[vote.b].sign;
            return signs == 0 ? std::abs(vote.same) : vote.same * signs;
        };
        std::sort(votes_.begin(), votes_.end(), [&](const Vote& v, const Vote& w) {
            const double x = kept(v), y = kept(w);
            return x != y ? x > y : v.a != w.a ? v.a < w.a : v.b < w.b;
        });
        links_.assign(nodes_.size(), {});
        order_.clear();
        SignedForest joined(static_cast<uint32_t>(nodes_.size()));
        for (const Vote& vote : votes_)
            if (joined.unite(vote.a, vote.b, vote.same < 0)) {
                links_[vote.a].push_back({vote.b, vote.same < 0});
                links_[vote.b].push_back({vote.a, vote.same < 0});
            }
        std::vector<bool> reached(nodes_.size(), false);
        for (uint32_t node = 0; node < nodes_.size(); ++node)
            if (!reached[node]) grow(node, reached);
        for (Vote& vote : votes_) vote.meet = meet(vote.a, vote.b);
    }

    /// Returns the sum of the votes that agree less the others.
    double agreed() const {
        double sum = 0;
        for (const Vote& vote : votes_) sum += vote.same * nodes_[vote.a].sign * nodes_[vote.b].sign;
        return sum;
    }

    /// Each link divides its tree into two parts. Where the sum of all votes across it contradicts the link,
    /// flips the lower part. Repeats this, the clearest case first, until no link is contradicted.
    void revise() {
        for (uint32_t at = worst(); at != kNone && work_ < kMostWork; at = worst()) {
            turn_below(at);
            work_ += static_cast<double>(votes_.size() + nodes_.size());
        }
    }

    /// Calls join(node, parent, opposite) for every link.
    template <class Join>
    void each(const Join& join) const {
        for (uint32_t i = 0; i < nodes_.size(); ++i)
            if (nodes_[i].parent != i)
                join(i, nodes_[i].parent, nodes_[i].sign != nodes_[nodes_[i].parent].sign);
    }

 private:
    static constexpr uint32_t kNone = UINT32_MAX;
    struct Link {
        uint32_t node;
        bool opposite;
    };
    struct Node {
        uint32_t parent = 0, depth = 0;
        uint32_t jump = 0;  ///< an ancestor far up (Myers 1983), so that deep trees are climbed in few steps
        int8_t sign = 0;
        bool below = false;
        /// Sum of the votes between the node's subtree and the rest of its tree; > 0 agrees with the link.
        double across = 0;
    };

    void grow(uint32_t root, std::vector<bool>& reached) {
        const int8_t own = nodes_[root].sign ? nodes_[root].sign : int8_t{1};
        nodes_[root] = {root, 0, root, own};
        reached[root] = true;
        size_t at = order_.size();
        order_.push_back(root);
        for (; at < order_.size(); ++at) {
            const uint32_t up = order_[at], far = nodes_[up].jump, farther = nodes_[far].jump;
            const bool equal =
                nodes_[up].depth - nodes_[far].depth == nodes_[far].depth - nodes_[farther].depth;
            for (const Link& link : links_[up]) {
                if (reached[link.node]) continue;
                reached[link.node] = true;
                const int8_t before = nodes_[link.node].sign;
                const int sign = link.opposite ? -nodes_[up].sign : nodes_[up].sign;
                nodes_[link.node] = {up, nodes_[up].depth + 1, equal ? farther : up,
                                     before ? before : static_cast<int8_t>(sign)};
                order_.push_back(link.node);
            }
        }
    }

    uint32_t meet(uint32_t a, uint32_t b) const {
        if (nodes_[a].depth < nodes_[b].depth) std::swap(a, b);
        while (nodes_[a].depth > nodes_[b].depth)
            a = nodes_[nodes_[a].jump].depth >= nodes_[b].depth ? nodes_[a].jump : nodes_[a].parent;
        while (a != b) {
            const bool far = nodes_[a].jump != nodes_[b].jump;
            a = far ? nodes_[a].jump : nodes_[a].parent;
            b = far ? nodes_[b].jump : nodes_[b].parent;
        }
        return a;
    }

    uint32_t worst() {
        for (Node& node : nodes_) node.across = 0;
        for (const Vote& vote : votes_) {
            const double kept = vote.same * nodes_[vote.a].sign * nodes_[vote.b].sign;
            nodes_[vote.a].across += kept;
            nodes_[vote.b].across += kept;
            nodes_[vote.meet].across -= 2 * kept;
        }
        uint32_t worst = kNone;
        double least = kAgainst;
        for (size_t i = order_.size(); i-- > 0;) {
            const uint32_t at = order_[i];
            if (nodes_[at].parent == at) continue;
            nodes_[nodes_[at].parent].across += nodes_[at].across;
            if (nodes_[at].across < least) least = nodes_[at].across, worst = at;
        }
        return worst;
    }

    void turn_below(uint32_t top) {
        for (const uint32_t at : order_) {  // parents first
            Node& node = nodes_[at];
            node.below = at == top || (node.parent != at && nodes_[node.parent].below);
            if (node.below) node.sign = static_cast<int8_t>(-node.sign);
        }
    }

    std::vector<Vote> votes_;
    std::vector<std::vector<Link>> links_;
    std::vector<Node> nodes_;
    std::vector<uint32_t> order_;  ///< parents before children
    double work_ = 0;              ///< of revise() so far, see kMostWork
};

}  // namespace

void SignVotes::unite(SignedForest& forest, unsigned rounds) const {
    std::unordered_map<uint64_t, double> open;  // votes between nodes that are not joined yet
    for (const auto& [pair, vote] : votes_) {
        const auto a = forest.find(static_cast<uint32_t>(pair >> 32)),
                   b = forest.find(static_cast<uint32_t>(pair));
        if (a.node != b.node) open[key(a.node, b.node)] += a.opposite != b.opposite ? -vote : vote;
    }
    std::vector<uint32_t> nodes;
    for (const auto& [pair, vote] : open)
        for (const uint64_t node : {pair >> 32, pair}) nodes.push_back(static_cast<uint32_t>(node));
    std::sort(nodes.begin(), nodes.end());
    nodes.erase(std::unique(nodes.begin(), nodes.end()), nodes.end());
    const auto number = [&](uint64_t node) {
        const auto at = std::lower_bound(nodes.begin(), nodes.end(), static_cast<uint32_t>(node));
        return static_cast<uint32_t>(at - nodes.begin());
    };
    std::vector<Vote> votes;
    for (const auto& [pair, vote] : open) votes.push_back({number(pair >> 32), number(pair), vote});
    Ballot ballot(static_cast<uint32_t>(nodes.size()), std::move(votes));
    ballot.revise();
    for (unsigned round = 1; round < rounds; ++round) {
        const double before = ballot.agreed();
        ballot.build();
        ballot.revise();
        if (!(ballot.agreed() > before)) break;
    }
    ballot.each([&](uint32_t node, uint32_t parent, bool opposite) {
        forest.unite(nodes[node], nodes[parent], opposite);
    });
}

}  // namespace lucarne::octree
