#include "octree/normals/orientation.h"

#include <algorithm>
#include <cmath>
#include <limits>
#include <numeric>
#include <tuple>

#include <glm/geometric.hpp>

#include "io/core/parallel.h"
#include "octree/normals/signed_forest.h"

namespace lucarne::octree {
namespace {

constexpr float kParallel = 0.7f;  ///< |n.n'| from which no turn of the surface is assumed
constexpr size_t kGrades = 512;    ///< of doubt, for the counting sort of edges
constexpr size_t kVotesPerPair = 256;
constexpr float kClearlyUp = 0.3f;  ///< |n.z| of a topmost point that can be told from a wall's

bool has_normal(const glm::vec3& n) {
    return n != glm::vec3(0.0f);
}

/// The graph's edges in Kruskal's order: by rising doubt, then by site; found by a counting sort. An edge is
/// its place among all sites' slots.
struct SortedEdges {
    std::vector<uint32_t> slots;
    std::vector<uint16_t> grade;  ///< of each slot: doubt in steps, kOpposite
    static constexpr uint16_t kNone = 0xffff, kOpposite = 0x8000;
    bool opposite(uint32_t slot) const { return grade[slot] & kOpposite; }
};

SortedEdges sorted_edges(const ChunkNeighbours& neighbours, const ChunkSurface& surface) {
    const auto& edges = surface.edges;
    SortedEdges sorted;
    sorted.grade.resize(edges.size() * kSiteEdges);
    parallel_ranges(edges.size(), 4096, [&](size_t first, size_t last) {
        for (auto i = static_cast<uint32_t>(first); i < last; ++i)
            for (size_t e = 0; e < kSiteEdges; ++e) {
                auto& grade = sorted.grade[i * kSiteEdges + e];
                const uint32_t j = edges[i][e];
                grade = SortedEdges::kNone;
                if (j == kNoSite || !has_normal(surface.normals[i]) || !has_normal(surface.normals[j]))
                    continue;
                // An edge known from both ends is taken once.
                if (j < i && std::find(edges[j].begin(), edges[j].end(), i) != edges[j].end()) continue;
                const glm::vec3 offset(neighbours.position(j) - neighbours.position(i));
                const Agreement a = agreement(surface.normals[i], surface.normals[j], offset);
                grade = static_cast<uint16_t>(a.doubt * (kGrades - 1));
                if (a.opposite) grade |= SortedEdges::kOpposite;
            }
    });
    std::vector<uint32_t> starts(kGrades + 1, 0);
    for (const uint16_t grade : sorted.grade)
        if (grade != SortedEdges::kNone) ++starts[(grade & ~SortedEdges::kOpposite) + 1];
    std::partial_sum(starts.begin(), starts.end(), starts.begin());
    sorted.slots.resize(starts.back());
    for (uint32_t slot = 0; slot < sorted.grade.size(); ++slot)
        if (const uint16_t grade = sorted.grade[slot]; grade != SortedEdges::kNone)
            sorted.slots[starts[grade & ~SortedEdges::kOpposite]++] = slot;
    return sorted;
}

uint64_t pair_key(uint32_t a, uint32_t b) {
    return static_cast<uint64_t>(std::min(a, b)) << 32 | std::max(a, b);
}

}  // namespace

Agreement agreement(const glm::vec3& normal, const glm::vec3& other, const glm::vec3& offset) {
    float same = glm::dot(normal, other);
    const float length2 = glm::dot(offset, offset);
    if (std::abs(same) < kParallel && length2 > 0)
        same -= 2.0f * glm::dot(normal, offset) * glm::dot(other, offset) / length2;
    return {same < 0, std::clamp(1.0f - std::abs(same), 0.0f, 1.0f)};
}

ChunkOrientation orient_chunk(const ChunkNeighbours& neighbours, ChunkSurface& surface,
                              std::span<const int8_t> toward) {
    auto& normals = surface.normals;
    const auto sites = static_cast<uint32_t>(normals.size());
    SignedForest forest(sites + 1);  // the last stands for the stations
    ChunkOrientation orientation;
    for (uint32_t i = 0; i < sites; ++i)
        if (toward[i] != 0 && has_normal(normals[i])) {
            forest.unite(sites, i, toward[i] < 0);
            orientation.anchored = true;
        }
    const SortedEdges sorted = sorted_edges(neighbours, surface);
    for (const uint32_t slot : sorted.slots)
        forest.unite(slot / kSiteEdges, surface.edges[slot / kSiteEdges][slot % kSiteEdges],
                     sorted.opposite(slot));

    orientation.components.assign(sites, 0);
    std::unordered_map<uint32_t, uint32_t> numbers;  // component by root
    const auto stations = forest.find(sites);
    if (orientation.anchored) numbers[stations.node] = 0;
    for (uint32_t i = 0; i < sites; ++i) {
        if (!has_normal(normals[i])) continue;
        const auto root = forest.find(i);
        const auto number =
            numbers.try_emplace(root.node, static_cast<uint32_t>(numbers.size())).first->second;
        orientation.components[i] = number;
        // Signs are relative to the root; those of the anchored component, to the stations.
        const bool turn = root.opposite != (orientation.anchored && number == 0 && stations.opposite);
        if (turn) normals[i] = -normals[i];
    }
    orientation.count = std::max<uint32_t>(1, static_cast<uint32_t>(numbers.size()));
    return orientation;
}

void OrientationMerger::add_empty() {
    first_component_.push_back(static_cast<uint32_t>(components_.size()));
}

void OrientationMerger::add(const ChunkNeighbours& neighbours, const ChunkSurface& surface,
                            const ChunkOrientation& orientation) {
    const uint32_t base = first_component_.back();
    Component fresh;
    fresh.top = -std::numeric_limits<double>::infinity();
    components_.resize(components_.size() + orientation.count, fresh);
    components_[base].anchored = orientation.anchored;
    for (uint32_t site = 0; site < surface.normals.size(); ++site) {
        if (!has_normal(surface.normals[site])) continue;
        auto& component = components_[base + orientation.components[site]];
        const double z = neighbours.position(site).z;
        if (z > component.top) {
            component.top = z;
            component.top_normal = surface.normals[site].z;
        }
        component.normal_sum += surface.normals[site].z * surface.areas[site];
    }
    hear(neighbours, surface, orientation);
    tell(surface, orientation);
    add_empty();  // closes this chunk's range
}

void OrientationMerger::hear(const ChunkNeighbours& neighbours, const ChunkSurface& surface,
                             const ChunkOrientation& orientation) {
    const size_t chunk = first_component_.size() - 1;
    auto inbox = std::exchange(inboxes_[chunk], {});
    if (inbox.empty()) return;
    std::vector<uint32_t> site_of;
    for (uint32_t site = 0; site < surface.normals.size(); ++site)
        for (const uint32_t point : neighbours.members(site)) {
            if (site_of.size() <= point) site_of.resize(point + 1);
            site_of[point] = site;
        }
    for (const Message& message : inbox) {
        const uint32_t site = site_of[message.index];
        if (!has_normal(surface.normals[site])) continue;
        const Agreement a = agreement(message.normal, surface.normals[site], message.offset);
        const uint32_t component = first_component_.back() + orientation.components[site];
        votes_[pair_key(message.component, component)] += a.opposite ? a.doubt - 1.0 : 1.0 - a.doubt;
    }
}

void OrientationMerger::tell(const ChunkSurface& surface, const ChunkOrientation& orientation) {
    const size_t chunk = first_component_.size() - 1;
    struct Letter {
        uint32_t chunk, component, edge;
    };
    std::vector<Letter> letters;
    for (uint32_t e = 0; e < surface.border.size(); ++e) {
        const BorderEdge& edge = surface.border[e];
        if (edge.other.chunk > chunk && has_normal(surface.normals[edge.site]))
            letters.push_back({edge.other.chunk, orientation.components[edge.site], e});
    }
    std::sort(letters.begin(), letters.end(), [](const Letter& a, const Letter& b) {
        return std::tie(a.chunk, a.component, a.edge) < std::tie(b.chunk, b.component, b.edge);
    });
    for (size_t first = 0, last; first < letters.size(); first = last) {
        for (last = first; last < letters.size() && letters[last].chunk == letters[first].chunk &&
                           letters[last].component == letters[first].component;)
            ++last;
        const size_t stride = (last - first + kVotesPerPair - 1) / kVotesPerPair;
        for (size_t i = first; i < last; i += stride) {
            const BorderEdge& edge = surface.border[letters[i].edge];
            inboxes_[letters[i].chunk].push_back({first_component_.back() + letters[i].component,
                                                  edge.other.index, surface.normals[edge.site], edge.offset});
        }
    }
}

std::vector<std::vector<int8_t>> OrientationMerger::signs() const {
    const auto count = static_cast<uint32_t>(components_.size());
    SignedForest forest(count + 1);  // the last stands for the stations
    for (uint32_t c = 0; c < count; ++c)
        if (components_[c].anchored) forest.unite(c, count, false);
    std::vector<std::pair<uint64_t, double>> votes(votes_.begin(), votes_.end());
    std::sort(votes.begin(), votes.end(), [](const auto& a, const auto& b) {
        const double x = std::abs(a.second), y = std::abs(b.second);
        return x != y ? x > y : a.first < b.first;
    });
    for (const auto& [pair, vote] : votes)
        forest.unite(static_cast<uint32_t>(pair >> 32), static_cast<uint32_t>(pair), vote < 0);

    struct Whole {
        double top = -std::numeric_limits<double>::infinity();
        double top_normal = 0, normal_sum = 0;
    };
    std::unordered_map<uint32_t, Whole> wholes;  // by root, as the root is turned
    for (uint32_t c = 0; c < count; ++c) {
        const auto root = forest.find(c);
        auto& whole = wholes[root.node];
        const double sign = root.opposite ? -1 : 1;
        if (components_[c].top > whole.top) {
            whole.top = components_[c].top;
            whole.top_normal = sign * components_[c].top_normal;
        }
        whole.normal_sum += sign * components_[c].normal_sum;
    }
    const auto stations = forest.find(count);
    std::vector<std::vector<int8_t>> signs(first_component_.size() - 1);
    for (size_t chunk = 0; chunk < signs.size(); ++chunk) {
        const uint32_t first = first_component_[chunk], last = first_component_[chunk + 1];
        signs[chunk].assign(std::max(1u, last - first), 1);
        for (uint32_t c = first; c < last; ++c) {
            const auto root = forest.find(c);
            bool turn = root.opposite;
            if (root.node == stations.node) {
                turn = turn != stations.opposite;
            } else {
                const Whole& whole = wholes[root.node];
                const double up =
                    std::abs(whole.top_normal) > kClearlyUp ? whole.top_normal : whole.normal_sum;
                turn = turn != (up < 0);
            }
            signs[chunk][c - first] = turn ? -1 : 1;
        }
    }
    return signs;
}

}  // namespace lucarne::octree
