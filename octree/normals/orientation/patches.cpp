#include "octree/normals/orientation/patches.h"

#include <algorithm>
#include <bit>
#include <cmath>

#include <glm/geometric.hpp>

#include "octree/normals/orientation/signed_forest.h"
#include "octree/tree/radix_sort.h"

namespace lucarne::octree {
namespace {

constexpr uint32_t kNone = UINT32_MAX;
constexpr float kAlike = 0.9f;     ///< least n.n' of a site and the patch's first one: 25 degrees
constexpr size_t kSmallPiece = 8;  ///< pieces of less than 1/kSmallPiece of a patch join their neighbours

/// Pieces that grow breadth first, each from the first site that has none.
struct Pieces {
    std::vector<uint32_t> of;  ///< of each site; kNone where it has no normal
    std::vector<size_t> sizes;
};

Pieces grow(const PatchGraph& graph, std::span<const glm::vec3> normals, size_t size) {
    Pieces pieces{std::vector<uint32_t>(normals.size(), kNone), {}};
    std::vector<uint32_t> front;
    for (uint32_t first = 0; first < normals.size(); ++first) {
        if (pieces.of[first] != kNone || normals[first] == glm::vec3(0.0f)) continue;
        const auto own = static_cast<uint32_t>(pieces.sizes.size());
        front.assign(1, first);
        pieces.of[first] = own;
        for (size_t at = 0; at < front.size() && front.size() < size; ++at) {
            const uint32_t site = front[at];
            for (uint32_t e = 0; e < kSiteEdges && front.size() < size; ++e) {
                if (!(graph.along[site] >> e & 1)) continue;
                const uint32_t next = graph.edges[site][e];
                if (pieces.of[next] != kNone || !(glm::dot(normals[first], normals[next]) > kAlike)) continue;
                pieces.of[next] = own;
                front.push_back(next);
            }
        }
        pieces.sizes.push_back(front.size());
    }
    return pieces;
}

/// Sums up the edges by pairs of pieces.
std::vector<PatchVote> votes_between(const Pieces& pieces, const PatchGraph& graph) {
    const auto bits = static_cast<uint32_t>(std::bit_width(pieces.sizes.size()));
    std::vector<CodeIndex> edges;  // the index is the edge's vote
    for (uint32_t site = 0; site < pieces.of.size(); ++site)
        for (uint32_t e = 0; e < kSiteEdges; ++e) {
            const uint32_t next = graph.edges[site][e];
            if (next == kNoSite || pieces.of[next] == pieces.of[site]) continue;
            const float same = graph.same(site, e);
            if (same == 0) continue;
            const auto [a, b] = std::minmax(pieces.of[site], pieces.of[next]);
            edges.push_back({uint64_t{a} << bits | b, std::bit_cast<uint32_t>(same)});
        }
    sort_by_code(edges, 2 * bits);
    std::vector<PatchVote> votes;
    for (size_t first = 0, last; first < edges.size(); first = last) {
        double sum = 0;
        for (last = first; last < edges.size() && edges[last].code == edges[first].code; ++last)
            sum += std::bit_cast<float>(edges[last].index);
        const uint64_t code = edges[first].code;
        votes.push_back({static_cast<uint32_t>(code >> bits),
                         static_cast<uint32_t>(code & ((uint64_t{1} << bits) - 1)), sum});
    }
    return votes;
}

}  // namespace

Patches divide_into_patches(const PatchGraph& graph, std::vector<glm::vec3>& normals, size_t size) {
    Pieces pieces = grow(graph, normals, size);
    auto votes = votes_between(pieces, graph);

    const auto count = static_cast<uint32_t>(pieces.sizes.size());
    SignedForest forest(count);
    std::vector<uint32_t> strongest(votes.size());
    for (uint32_t i = 0; i < strongest.size(); ++i) strongest[i] = i;
    std::stable_sort(strongest.begin(), strongest.end(), [&](uint32_t i, uint32_t j) {
        return std::abs(votes[i].same) > std::abs(votes[j].same);
    });
    for (const uint32_t i : strongest) {
        const uint32_t a = forest.find(votes[i].a).node, b = forest.find(votes[i].b).node;
        if (a == b || std::min(pieces.sizes[a], pieces.sizes[b]) * kSmallPiece >= size) continue;
        forest.unite(votes[i].a, votes[i].b, votes[i].same < 0);
        pieces.sizes[forest.find(a).node] = pieces.sizes[a] + pieces.sizes[b];
    }

    Patches patches;
    patches.count = 0;
    std::vector<uint32_t> numbers(count, kNone);  // by piece
    for (uint32_t piece = 0; piece < count; ++piece) {
        uint32_t& number = numbers[forest.find(piece).node];
        if (number == kNone) number = patches.count++;
        numbers[piece] = number;
    }
    patches.count = std::max(1u, patches.count);
    patches.of.assign(normals.size(), 0);
    for (uint32_t site = 0; site < normals.size(); ++site) {
        const uint32_t piece = pieces.of[site];
        if (piece == kNone) continue;
        patches.of[site] = numbers[piece];
        if (forest.find(piece).opposite) normals[site] = -normals[site];
    }
    for (const PatchVote& vote : votes) {
        const auto [a, b] = std::minmax(numbers[vote.a], numbers[vote.b]);
        const bool turned = forest.find(vote.a).opposite != forest.find(vote.b).opposite;
        if (a != b) patches.votes.push_back({a, b, turned ? -vote.same : vote.same});
    }
    return patches;
}

}  // namespace lucarne::octree
