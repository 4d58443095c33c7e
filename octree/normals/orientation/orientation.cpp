#include "octree/normals/orientation/orientation.h"

#include <algorithm>
#include <cmath>
#include <limits>
#include <numeric>
#include <tuple>

#include <glm/geometric.hpp>

#include "io/core/parallel.h"
#include "octree/normals/orientation/signed_forest.h"

namespace lucarne::octree {
namespace {

constexpr float kParallel = 0.7f;  ///< |n.n'| from which the surface is taken as not turning
constexpr size_t kGrades = 512;    ///< steps of doubt in the counting sort of edges
constexpr float kSteep = 0.5f;     ///< squared sine of an offset's angle to a plane: 45 degrees
constexpr float kSmooth = 0.1f;    ///< doubt up to which a single edge is trusted: 25 degrees
/// Squared sine of an edge's angle to the planes of its ends up to which it runs along their surface: 18
/// degrees. Edges from one face of a board to the other are steeper.
constexpr float kFlatStep = 0.1f;
constexpr float kSmoothStep = 0.95f;  ///< |n.n'| from which the surface does not turn along it: 18 degrees
/// Share of the discs without a station's word from which their sides are asked by sight.
constexpr double kInDoubt = 0.02;
constexpr unsigned kRounds = 8;  ///< forests that are tried where sides are asked by sight
constexpr size_t kVotesPerPair = 256;
constexpr std::ptrdiff_t kAhead = 12;  ///< how many edges ahead memory is asked for

bool has_normal(const glm::vec3& n) {
    return n != glm::vec3(0.0f);
}

/// The graph's edges in Kruskal's order: by rising doubt, then by site, from a counting sort. An edge is
/// identified by its slot: its index among the edge slots of all sites.
struct SortedEdges {
    std::vector<uint32_t> slots;
    std::vector<uint16_t> grade;  ///< of each slot: doubt in steps, and kOpposite
    std::vector<uint8_t> along;   ///< of each site, as PatchGraph::along
    static constexpr uint16_t kNone = 0xffff, kOpposite = 0x8000;
    bool opposite(uint32_t slot) const { return grade[slot] & kOpposite; }
    float doubt(uint32_t slot) const { return static_cast<float>(grade[slot] & ~kOpposite) / (kGrades - 1); }
};

/// Whether an edge runs along a surface that does not turn between its ends.
bool runs_along(const glm::vec3& normal, const glm::vec3& other, const glm::vec3& offset) {
    const float rise = glm::dot(normal, offset), other_rise = glm::dot(other, offset);
    return std::abs(glm::dot(normal, other)) > kSmoothStep &&
           std::max(rise * rise, other_rise * other_rise) < kFlatStep * glm::dot(offset, offset);
}

SortedEdges sorted_edges(const ChunkNeighbours& neighbours, const ChunkSurface& surface) {
    const auto& edges = surface.edges;
    SortedEdges sorted;
    sorted.grade.resize(edges.size() * kSiteEdges);
    sorted.along.assign(edges.size(), 0);
    parallel_ranges(edges.size(), 4096, [&](size_t first, size_t last) {
        for (auto i = static_cast<uint32_t>(first); i < last; ++i)
            for (size_t e = 0; e < kSiteEdges; ++e) {
                auto& grade = sorted.grade[i * kSiteEdges + e];
                const uint32_t j = edges[i][e];
                grade = SortedEdges::kNone;
                if (j == kNoSite || !has_normal(surface.normals[i]) || !has_normal(surface.normals[j]))
                    continue;
                const glm::vec3 offset(neighbours.position(j) - neighbours.position(i));
                if (runs_along(surface.normals[i], surface.normals[j], offset))
                    sorted.along[i] |= static_cast<uint8_t>(1u << e);
                // An edge known from both ends is used once.
                if (j < i && std::find(edges[j].begin(), edges[j].end(), i) != edges[j].end()) continue;
                const Agreement a = agreement(surface.normals[i], surface.normals[j], offset);
                if (a.doubt >= 1) continue;
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

}  // namespace

Agreement agreement(const glm::vec3& normal, const glm::vec3& other, const glm::vec3& offset) {
    float same = glm::dot(normal, other);
    const float length2 = glm::dot(offset, offset);
    const float rise = glm::dot(normal, offset), other_rise = glm::dot(other, offset);
    if (std::abs(same) < kParallel) {
        if (length2 > 0) same -= 2.0f * rise * other_rise / length2;
    } else if (std::max(rise * rise, other_rise * other_rise) > kSteep * length2) {
        return {same < 0, 1.0f};
    }
    return {same < 0, std::clamp(1.0f - std::abs(same), 0.0f, 1.0f)};
}

ChunkOrientation orient_chunk(const ChunkNeighbours& neighbours, ChunkSurface& surface,
                              std::span<const int8_t> toward, const OrientationDetail& detail) {
    auto& normals = surface.normals;
    const auto sites = static_cast<uint32_t>(normals.size());
    SignedForest forest(sites + 1);  // the last node represents the stations
    ChunkOrientation orientation;
    for (uint32_t i = 0; i < sites; ++i)
        if (toward[i] != 0 && has_normal(normals[i])) {
            forest.unite(sites, i, toward[i] < 0);
            orientation.anchored = true;
        }
    const SortedEdges sorted = sorted_edges(neighbours, surface);
    const auto target = [&](uint32_t slot) { return surface.edges[slot / kSiteEdges][slot % kSiteEdges]; };
    const auto crease = std::find_if(sorted.slots.begin(), sorted.slots.end(),
                                     [&](uint32_t slot) { return sorted.doubt(slot) > kSmooth; });
    // Edges of equal doubt are all over the chunk, so memory is asked for what the next ones need: first for
    // their ends, later for the links of these.
    const auto ahead = [&](auto at, std::ptrdiff_t steps) {
        return *(crease - at > steps ? at + steps : at);
    };
    for (auto at = sorted.slots.begin(); at != crease; ++at) {
        const uint32_t far = ahead(at, 2 * kAhead), near = ahead(at, kAhead);
        __builtin_prefetch(&surface.edges[far / kSiteEdges][far % kSiteEdges]);
        __builtin_prefetch(&sorted.grade[far]);
        forest.prefetch(near / kSiteEdges);
        forest.prefetch(target(near));
        forest.unite(*at / kSiteEdges, target(*at), sorted.opposite(*at));
    }
    SignVotes votes;
    for (const uint32_t slot : std::span(crease, sorted.slots.end())) {
        const auto a = forest.find(slot / kSiteEdges), b = forest.find(target(slot));
        if (a.node == b.node) continue;
        votes.add(a.node, b.node, sorted.opposite(slot) != (a.opposite != b.opposite),
                  1.0f - sorted.doubt(slot));
    }
    votes.unite(forest);

    orientation.components.assign(sites, 0);
    std::vector<uint8_t> flipped(sites, 0);
    std::unordered_map<uint32_t, uint32_t> numbers;  // component by root
    const auto stations = forest.find(sites);
    if (orientation.anchored) numbers[stations.node] = 0;
    for (uint32_t i = 0; i < sites; ++i) {
        if (!has_normal(normals[i])) continue;
        const auto root = forest.find(i);
        const auto number =
            numbers.try_emplace(root.node, static_cast<uint32_t>(numbers.size())).first->second;
        orientation.components[i] = number;
        // Signs are relative to the root, those of the anchored component relative to the stations.
        const bool turn = root.opposite != (orientation.anchored && number == 0 && stations.opposite);
        if (turn) normals[i] = -normals[i];
        flipped[i] = turn;
    }
    orientation.count = std::max<uint32_t>(1, static_cast<uint32_t>(numbers.size()));
    if (orientation.anchored) return orientation;
    const auto same = [&](uint32_t site, uint32_t e) {
        const uint32_t slot = site * static_cast<uint32_t>(kSiteEdges) + e;
        if (sorted.grade[slot] == SortedEdges::kNone) return 0.0f;
        const uint32_t other = surface.edges[site][e];
        const float agree = 1 - sorted.doubt(slot);
        return sorted.opposite(slot) != (flipped[site] != flipped[other]) ? -agree : agree;
    };
    Patches patches = divide_into_patches({surface.edges, sorted.along, same}, normals, detail.patch);
    orientation.components = std::move(patches.of);
    orientation.count = patches.count;
    orientation.votes = std::move(patches.votes);
    return orientation;
}

OrientationDetail OrientationDetail::of(const ChunkAccess& chunks, uint64_t memory) {
    constexpr uint64_t kLeastPatch = 64, kMostPatches = 16384, kMostDiscs = 65536;
    constexpr uint64_t kPatchMemory = 8192, kDiscMemory = 1024;  // bytes of `memory` for each of them
    const uint64_t patches = std::clamp<uint64_t>(memory / kPatchMemory, 1, kMostPatches),
                   discs = std::clamp<uint64_t>(memory / kDiscMemory, 1, kMostDiscs);
    uint64_t points = 0;
    for (size_t chunk = 0; chunk < chunks.chunk_count(); ++chunk) points += chunks.point_count(chunk);
    return {static_cast<size_t>(std::max(kLeastPatch, points / patches)),
            static_cast<size_t>(points / discs + 1)};
}

void VoteSums::add(const ComponentVote& vote) {
    const auto [at, first] = index_.try_emplace({vote.chunk, vote.component, vote.own}, votes_.size());
    if (first) votes_.push_back({vote.chunk, vote.component, vote.own, 0});
    votes_[at->second].same += vote.same;
}

ComponentVote BorderMessage::heard(const glm::vec3& other, uint32_t own) const {
    const Agreement a = agreement(normal, other, offset);
    const double weight = 1.0 - a.doubt;
    return {chunk, component, own, a.opposite ? -weight : weight};
}

ChunkVotes BorderMail::finish(uint32_t chunk, const ChunkNeighbours& neighbours, const ChunkSurface& surface,
                              const ChunkOrientation& orientation) {
    ChunkVotes votes;
    votes.components.resize(orientation.count);
    votes.components[0].anchored = orientation.anchored;
    const auto each = [&](auto&& visit) {
        for (uint32_t site = 0; site < surface.normals.size(); ++site)
            if (has_normal(surface.normals[site]))
                visit(votes.components[orientation.components[site]].shell, site);
    };
    each([&](Shell& shell, uint32_t site) { shell.extend(neighbours.position(site)); });
    each([&](Shell& shell, uint32_t site) {
        shell.add(neighbours.position(site), surface.normals[site], surface.areas[site]);
    });
    votes.discs = discs(neighbours, surface, orientation);
    votes.votes = hear(chunk, neighbours, surface, orientation);
    for (const PatchVote& vote : orientation.votes) votes.votes.push_back({chunk, vote.a, vote.b, vote.same});
    tell(chunk, surface, orientation);
    return votes;
}

std::vector<SightDisc> BorderMail::discs(const ChunkNeighbours& neighbours, const ChunkSurface& surface,
                                         const ChunkOrientation& orientation) const {
    std::vector<SightDisc> found;
    found.reserve(surface.normals.size() / detail_.disc + 1);
    float area = 0;
    size_t sites = 0;
    for (uint32_t site = 0; site < surface.normals.size(); ++site) {
        if (!has_normal(surface.normals[site]) || !(surface.areas[site] > kStrayArea)) continue;
        area += surface.areas[site];
        if (++sites % detail_.disc != 0) continue;
        found.push_back(
            {neighbours.position(site), surface.normals[site], area, orientation.components[site]});
        area = 0;
    }
    return found;
}

std::vector<ComponentVote> BorderMail::hear(uint32_t chunk, const ChunkNeighbours& neighbours,
                                            const ChunkSurface& surface,
                                            const ChunkOrientation& orientation) {
    const auto inbox = std::exchange(inboxes_[chunk], {});
    if (inbox.empty()) return {};
    std::vector<uint32_t> site_of;
    for (uint32_t site = 0; site < surface.normals.size(); ++site)
        for (const uint32_t point : neighbours.members(site)) {
            if (site_of.size() <= point) site_of.resize(point + 1);
            site_of[point] = site;
        }
    VoteSums votes;
    for (const BorderMessage& message : inbox) {
        const uint32_t site = site_of[message.index];
        if (!has_normal(surface.normals[site])) continue;
        votes.add(message.heard(surface.normals[site], orientation.components[site]));
    }
    return votes.take();
}

void BorderMail::tell(uint32_t chunk, const ChunkSurface& surface, const ChunkOrientation& orientation) {
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
        const uint32_t to = letters[first].chunk;
        auto& box = to < inboxes_.size() ? inboxes_[to] : outgoing_;
        const size_t stride = (last - first + kVotesPerPair - 1) / kVotesPerPair;
        for (size_t i = first; i < last; i += stride) {
            const BorderEdge& edge = surface.border[letters[i].edge];
            box.push_back(
                {chunk, letters[i].component, to, edge.other.index, surface.normals[edge.site], edge.offset});
        }
    }
}

void OrientationMerger::add(const ChunkVotes& chunk) {
    const uint32_t base = first_component_.back();
    components_.insert(components_.end(), chunk.components.begin(), chunk.components.end());
    for (const ComponentVote& vote : chunk.votes)
        votes_.add(first_component_[vote.chunk] + vote.component, base + vote.own, vote.same);
    for (SightDisc disc : chunk.discs) {
        disc.component += base;
        discs_.push_back(disc);
    }
    first_component_.push_back(static_cast<uint32_t>(components_.size()));
}

bool OrientationMerger::in_doubt() const {
    size_t without = 0;
    for (const SightDisc& disc : discs_) without += !components_[disc.component].anchored;
    return static_cast<double>(without) > kInDoubt * static_cast<double>(discs_.size());
}

std::vector<bool> OrientationMerger::inside_out(SignedForest& forest, SignedForest& surfaces) const {
    const auto count = static_cast<uint32_t>(components_.size());
    std::vector<Shell> wholes(count);  // in the orientation of the root of `forest`
    for (uint32_t c = 0; c < count; ++c)
        wholes[surfaces.find(c).node].join(components_[c].shell, forest.find(c).opposite);
    std::vector<double> balance(count + 1, 0);
    for (uint32_t c = 0; c < count; ++c)
        if (surfaces.find(c).node == c)
            balance[forest.find(c).node] +=
                wholes[c].inside_out() ? wholes[c].evidence() : -wholes[c].evidence();
    std::vector<bool> turned(count + 1);
    for (uint32_t root = 0; root <= count; ++root) turned[root] = balance[root] > 0;
    return turned;
}

OrientationSigns OrientationMerger::signs() {
    const auto count = static_cast<uint32_t>(components_.size());
    SignedForest forest(count + 1);  // the last node represents the stations
    for (uint32_t c = 0; c < count; ++c)
        if (components_[c].anchored) forest.unite(c, count, false);
    SignedForest surfaces(count);
    votes_.each([&](uint32_t a, uint32_t b) { surfaces.unite(a, b, false); });
    const bool doubtful = in_doubt();
    if (doubtful) vote_by_sight(discs_, detail_.disc, votes_);
    std::vector<SightDisc>().swap(discs_);
    votes_.unite(forest, doubtful ? kRounds : 1);

    const auto turned = inside_out(forest, surfaces);
    const auto stations = forest.find(count);
    OrientationSigns signs(first_component_.size() - 1);
    for (size_t chunk = 0; chunk < signs.size(); ++chunk) {
        const uint32_t first = first_component_[chunk], last = first_component_[chunk + 1];
        signs[chunk].assign(std::max(1u, last - first), 1);
        for (uint32_t c = first; c < last; ++c) {
            const auto root = forest.find(c);
            const bool whole = root.node == stations.node ? stations.opposite : turned[root.node];
            const bool turn = root.opposite != whole;
            const auto surface = static_cast<int32_t>(surfaces.find(c).node) + 1;
            signs[chunk][c - first] = turn ? -surface : surface;
        }
    }
    return signs;
}

}  // namespace lucarne::octree
