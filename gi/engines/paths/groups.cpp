#include "gi/engines/paths/groups.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <memory>
#include <numeric>
#include <utility>

#include <glm/common.hpp>
#include <glm/geometric.hpp>

#include "gi/shared/surfel_code.h"
#include "octree/tree/key.h"
#include "octree/tree/radix_sort.h"

namespace lucarne::gi::paths {
namespace {

constexpr uint32_t kLevels = 20;     ///< of the octree: one bit of each coordinate a level
constexpr size_t kFewestInCell = 4;  ///< surfels; cells with fewer are not divided
constexpr float kFit = 1.25f;        ///< a cell fits into a ray that is this much narrower
/// Parallel sheets are different surfaces if they are farther apart than so many radii of their discs; where
/// normals turn, this share of the turn (at most kMostTurn) times the distance along the surface is allowed.
constexpr float kSheet = 2, kCurved = 0.5f, kMostTurn = 0.5f;
/// Cells with more surfaces than this are not joined: foliage, for example.
constexpr size_t kMostParts = 256;
/// Parts of a sheet at most: one that is noisier than its discs are wide hides its own sides.
constexpr size_t kMostDivided = 4;
constexpr float kFarther = 0.01f;  ///< by this share rays go beyond the point where they meet
/// Fewer leaves than this that see each other see nothing else: the inside of walls, and foliage. They are
/// not joined.
constexpr uint32_t kFewestOfAir = 16;
/// Surfels of cells that are divided, and pairs of groups that are tested, between two looks at whether to
/// stop.
constexpr size_t kDividedAtOnce = 65536, kJoinedAtOnce = 16384;
constexpr float kLeastWeight = 1e-12f;  ///< m^2, of surfels without an area

/// Returns the root of a number's tree, and shortens the way to it.
uint32_t root_of(std::vector<uint32_t>& next, uint32_t number) {
    while (next[number] != number) number = next[number] = next[next[number]];
    return number;
}

}  // namespace

uint32_t Groups::fitting(uint32_t leaf, float width) const {
    uint32_t group = leaf;
    while (parent[group] != kNone && cell[parent[group]] <= kFit * width) group = parent[group];
    return group;
}

Groups GroupBuilder::take() {
    Groups groups = std::move(joining_->groups);
    joining_.reset();
    return groups;
}

std::vector<GroupPlane> Groups::find_planes() const {
    std::vector<GroupPlane> found(count());
    for (uint32_t leaf = 0; leaf < leaves; ++leaf) {
        const LeafPlane& plane = planes[leaf];
        const glm::vec3 at(plane.centre[0], plane.centre[1], plane.centre[2]);
        const uint32_t normal = plane.normal;
        found[leaf] = {corner + (at + .5f) * (edge / 65536),
                       decode_octahedral((normal & 0xffu) << 8 | (normal & 0xff00u) << 16 | 0x800080u)};
    }
    for (uint32_t group = leaves; group < count(); ++group) {
        glm::vec3 centre(0.0f), normal(0.0f);
        float sum = 0;
        for (const uint32_t child : children_of(group)) {
            const float weight = std::max(area[child], kLeastWeight);
            centre += weight * found[child].centre;
            normal += weight * found[child].normal;
            sum += weight;
        }
        const float length = glm::length(normal);
        found[group] = {centre / std::max(sum, kLeastWeight),
                        length > 0 ? normal / length : glm::vec3(0, 0, 1)};
    }
    return found;
}

GroupBuilder::GroupBuilder(const Surfaces& surfaces, std::span<const RayHit> hits, float least_cell)
    : surfaces_(surfaces), surfels_(surfaces.surfels()), leaf_of_(2 * surfels_.size(), kNone) {
    const SideSurfels& surfels = surfels_;
    glm::vec3 low(3e38f), high(-3e38f);
    for (size_t i = 0; i < surfels.size(); ++i) {
        const glm::vec3 position = surfels[i].position;
        low = glm::min(low, position);
        high = glm::max(high, position);
    }
    if (surfels.empty()) low = high = glm::vec3(0.0f);
    const glm::dvec3 size = glm::dvec3(high) - glm::dvec3(low);
    const double edge = std::max({size.x, size.y, size.z, 1e-6});
    edge_ = static_cast<float>(edge);
    corner_ = low;
    std::vector<octree::CodeIndex> codes;
    for (uint32_t i = 0; i < surfels.size(); ++i) {
        const glm::dvec3 at =
            (glm::dvec3(surfels[i].position) - glm::dvec3(low)) * (((1u << kLevels) - 1) / edge);
        codes.push_back({octree::morton(static_cast<uint64_t>(at.x), static_cast<uint64_t>(at.y),
                                        static_cast<uint64_t>(at.z)),
                         i});
    }
    octree::sort_by_code(codes, 3 * kLevels);
    for (const octree::CodeIndex& code : codes) {
        order_.push_back(code.index);
        codes_.push_back(code.code);
    }
    is_met_.assign(surfaces.parts().size(), false);
    for (const RayHit& hit : hits)
        if (hit.side != kNone && surfaces.is_part(hit.side)) is_met_[hit.side / 2 - surfaces.discs()] = true;
    find_wanted(hits, least_cell);
    if (!surfels.empty()) levels_.push_back({{.first = 0, .last = order_.size()}});
}

/// Finds the level whose cells fit into the narrowest ray that ends on each surfel.
void GroupBuilder::find_wanted(std::span<const RayHit> hits, float least_cell) {
    wanted_.assign(surfels_.size(), 0);
    for (const RayHit& hit : hits) {
        if (hit.side == kNone) continue;
        const double narrowest = std::max({kFit * hit.width, least_cell, 1e-9f});
        const double level = std::ceil(std::log2(double{edge_} / narrowest));
        uint8_t& most = wanted_[hit.side / 2];
        most = std::max(most, static_cast<uint8_t>(std::clamp<double>(level, 0, kLevels)));
    }
}

/// Whether a cell of the level that is being divided has parts.
bool GroupBuilder::is_divided(const Cell& cell) const {
    if (level_ >= kLevels || cell.last - cell.first <= kFewestInCell) return false;
    return std::any_of(order_.begin() + static_cast<std::ptrdiff_t>(cell.first),
                       order_.begin() + static_cast<std::ptrdiff_t>(cell.last),
                       [&](uint32_t surfel) { return wanted_[surfel] > level_; });
}

bool GroupBuilder::divide() {
    for (size_t done = 0; level_ < levels_.size() && done < kDividedAtOnce;) {
        if (cell_ == levels_[level_].size()) {
            if (!finer_.empty()) levels_.push_back(std::exchange(finer_, {}));
            ++level_;
            cell_ = 0;
            continue;
        }
        Cell& cell = levels_[level_][cell_++];
        done += cell.last - cell.first;
        if (!is_divided(cell)) {
            make_leaves(cell);
            continue;
        }
        const auto shift = static_cast<uint32_t>(3 * (kLevels - 1 - level_));
        cell.first_part = static_cast<uint32_t>(finer_.size());
        for (size_t first = cell.first; first < cell.last;) {
            const uint64_t octant = codes_[first] >> shift;
            size_t last = first + 1;
            while (last < cell.last && codes_[last] >> shift == octant) ++last;
            finer_.push_back({.first = first, .last = last});
            first = last;
        }
        cell.last_part = static_cast<uint32_t>(finer_.size());
    }
    if (level_ < levels_.size()) return true;
    codes_ = {};
    wanted_ = {};
    for (size_t i = 0; i < is_met_.size(); ++i)
        if (!is_met_[i]) leaf_of_[2 * (surfaces_.discs() + i)] = leaf_of_[surfaces_.parts()[i].side];
    airs_.resize(facts_.size());
    std::iota(airs_.begin(), airs_.end(), 0u);
    return false;
}

/// Whether a side is in the leaves. Of the parts of discs most are inside of walls, where nothing meets them.
bool GroupBuilder::is_there(Side side) const {
    return !surfaces_.is_part(side) || (side % 2 == 0 && is_met_[side / 2 - surfaces_.discs()]);
}

/// Returns a side's share of the surface, m^2, with those of its parts that are not there.
float GroupBuilder::area_of(Side side) const {
    float area = surfaces_.area_of(side);
    for (const CutOffPart& part : surfaces_.parts_of(side)) {
        const Side of_part = surfaces_.side_of_part(part);
        if (!is_there(of_part)) area += surfaces_.area_of(of_part);
    }
    return area;
}

void GroupBuilder::add(Facts& sum, const Facts& more) {
    sum.normal += more.normal;
    const float weight = sum.weight + more.weight;
    sum.centre += (more.centre - sum.centre) * (more.weight / weight);
    sum.weight = weight;
    sum.area += more.area;
    sum.radius = std::max(sum.radius, more.radius);
    if (sum.middle.radius == 0 ||
        glm::distance(more.middle.position, sum.centre) < glm::distance(sum.middle.position, sum.centre))
        sum.middle = more.middle;
}

void GroupBuilder::add_leaf(std::span<const Side> sides, uint32_t facing) {
    const auto number = static_cast<uint32_t>(facts_.size());
    Facts facts{.facing = facing};
    for (const Side side : sides) {
        const Surfel s = surfels_[side / 2];
        const float area = area_of(side), weight = std::max(area, kLeastWeight);
        add(facts, {weight * normal_of(surfels_, side), s.position, weight, area, s.radius,
                    start_at(surfels_, side)});
        leaf_of_[side] = number;
    }
    facts_.push_back(facts);
    sides_.insert(sides_.end(), sides.begin(), sides.end());
    starts_.push_back(static_cast<uint32_t>(sides_.size()));
}

/// Divides the sides in a cell by what they face, and where there is room between parallel sheets. A front
/// and a back that face the same way are the near sheet of a thin wall and the inside of its far one.
void GroupBuilder::make_leaves(Cell& cell) {
    cell.first_leaf = leaves();
    std::array<std::vector<Side>, 2 * kFacings> facing;  // of fronts, then of backs
    for (size_t i = cell.first; i < cell.last; ++i)
        for (const Side side : {2 * order_[i], 2 * order_[i] + 1})
            if (is_there(side))
                facing[facing_of(normal_of(surfels_, side)) + side % 2 * kFacings].push_back(side);
    for (uint32_t f = 0; f < 2 * kFacings; ++f) {
        std::vector<Side>& sides = facing[f];
        if (sides.empty()) continue;
        glm::vec3 normal(0.0f);
        for (const Side side : sides)
            normal += normal_of(surfels_, side) * std::max(surfels_[side / 2].area, kLeastWeight);
        normal = glm::normalize(normal);  // its largest component is not 0: all face the same way
        std::vector<std::pair<float, Side>> heights;
        for (const Side side : sides)
            heights.emplace_back(glm::dot(normal, surfels_[side / 2].position), side);
        std::ranges::stable_sort(heights, {}, [](const auto& item) { return item.first; });
        // A sheet's sides keep their order along the curve, so that every part of them is spread evenly.
        std::vector<float> gaps;  // the heights at which sheets begin
        for (size_t i = 1; i < heights.size(); ++i) {
            const float apart =
                surfels_[heights[i].second / 2].radius + surfels_[heights[i - 1].second / 2].radius;
            if (heights[i].first - heights[i - 1].first > apart) gaps.push_back(heights[i].first);
        }
        std::vector<std::vector<Side>> sheets(gaps.size() + 1);
        for (const Side side : sides) {
            const float height = glm::dot(normal, surfels_[side / 2].position);
            const auto sheet = std::ranges::upper_bound(gaps, height) - gaps.begin();
            sheets[static_cast<size_t>(sheet)].push_back(side);
        }
        for (const auto& sheet : sheets)
            for (const auto& part : divided_by_walls(sheet)) add_leaf(part, f);
    }
    cell.last_leaf = leaves();
}

/// Divides a sheet where something stands on it: a wall on a floor has other light in front of it than
/// behind.
std::vector<std::vector<Side>> GroupBuilder::divided_by_walls(std::span<const Side> sheet) const {
    std::vector<std::vector<Side>> parts;
    for (const Side side : sheet) {
        // The last one of a part is usually the nearest.
        auto own = std::ranges::find_if(parts, [&](const std::vector<Side>& part) {
            return surfaces_.see_each_other(side, part.back()) ||
                   surfaces_.see_each_other(side, part.front());
        });
        if (own == parts.end() && parts.size() == kMostDivided) --own;
        if (own == parts.end()) own = parts.emplace(own);
        own->push_back(side);
    }
    return parts;
}

void GroupBuilder::connect(uint32_t leaf, uint32_t other) {
    const uint32_t a = root_of(airs_, leaf), b = root_of(airs_, other);
    airs_[std::max(a, b)] = std::min(a, b);
}

/// Returns for each leaf a number that is the same for all that see the same air; kNone if few do.
std::vector<uint32_t> GroupBuilder::find_airs() const {
    std::vector<uint32_t> next = airs_, airs(facts_.size()), counts(facts_.size(), 0);
    for (uint32_t i = 0; i < airs.size(); ++i) ++counts[airs[i] = root_of(next, i)];
    for (uint32_t& air : airs)
        if (counts[air] < kFewestOfAir) air = kNone;
    return airs;
}

/// Whether two groups are parts of one surface, and nothing stands on it between them. Arcs of a curved one
/// lie symmetrically about their mean normal, so their centres are in one plane across it, unless their sizes
/// differ; parallel sheets are not.
bool GroupBuilder::on_one_surface(const Facts& one, const Facts& other) const {
    if (one.facing != other.facing || one.air != other.air || one.air == kNone) return false;
    const glm::vec3 first = glm::normalize(one.normal), second = glm::normalize(other.normal);
    const glm::vec3 mean = glm::normalize(first + second), apart = one.centre - other.centre;
    const float across = std::abs(glm::dot(mean, apart));
    const float along = glm::length(apart - mean * glm::dot(mean, apart));
    const float turn = std::min(glm::length(first - second), kMostTurn);
    if (across > kSheet * std::max(one.radius, other.radius) + kCurved * turn * along) return false;
    // Over the back of a curved surface: the tangents at its ends meet a quarter of the chord times its turn
    // above the chord.
    const auto origin = [](const RayStart& s) {
        return tracing::offset_origin(s.position, s.normal, s.radius);
    };
    const glm::vec3 from = origin(one.middle), to = origin(other.middle);
    const glm::vec3 over = (from + to) / 2.0f + mean * (turn * along / 4);
    // Both rays go a little farther, or a wall in the middle would end both.
    return !surfaces_.tracer().occluded(from, over + kFarther * (over - from)) &&
           !surfaces_.tracer().occluded(to, over + kFarther * (over - to));
}

void GroupBuilder::begin_joining() {
    joining_ = std::make_unique<Joining>();
    joining_->groups = {.leaves = leaves(), .leaf_of = leaf_of_, .first = {0}};
    joining_->facts = facts_;
    const std::vector<uint32_t> airs = find_airs();
    for (uint32_t i = 0; i < leaves(); ++i) joining_->facts[i].air = airs[i];
    joining_->groups.parent.assign(leaves(), kNone);
    joining_->groups.cell.resize(leaves());
    joining_->level = levels_.size();
}

/// Joins what a cell holds: its leaves, or the groups of its parts. Sets `found` to them, and returns how
/// many pairs were tested.
size_t GroupBuilder::join_cell(const Cell& cell, float edge, std::vector<uint32_t>& found) {
    Groups& groups = joining_->groups;
    std::vector<Facts>& facts = joining_->facts;
    for (uint32_t leaf = cell.first_leaf; leaf < cell.last_leaf; ++leaf) {
        groups.cell[leaf] = edge;
        found.push_back(leaf);
    }
    std::vector<uint32_t> parts;
    for (uint32_t part = cell.first_part; part < cell.last_part; ++part)
        for (const uint32_t group : joining_->finer[part])
            if (facts[group].air != kNone) parts.push_back(group);
    if (parts.size() > kMostParts) parts.clear();
    std::vector<uint32_t> next(parts.size());
    std::iota(next.begin(), next.end(), 0u);
    for (uint32_t i = 0; i < parts.size(); ++i)
        for (uint32_t j = i + 1; j < parts.size(); ++j)
            if (on_one_surface(facts[parts[i]], facts[parts[j]])) {
                const uint32_t a = root_of(next, i), b = root_of(next, j);
                next[std::max(a, b)] = std::min(a, b);
            }
    for (uint32_t i = 0; i < parts.size(); ++i) {
        if (root_of(next, i) != i) continue;
        const auto number = groups.count();
        Facts joined = facts[parts[i]];
        groups.parent[parts[i]] = number;
        groups.children.push_back(parts[i]);
        for (uint32_t j = i + 1; j < parts.size(); ++j) {
            if (root_of(next, j) != i) continue;
            add(joined, facts[parts[j]]);
            groups.parent[parts[j]] = number;
            groups.children.push_back(parts[j]);
        }
        groups.first.push_back(static_cast<uint32_t>(groups.children.size()));
        groups.parent.push_back(kNone);
        groups.cell.push_back(edge);
        facts.push_back(joined);
        found.push_back(number);
    }
    return parts.size() * (parts.size() + 1) / 2;
}

LeafPlane GroupBuilder::plane_of(const Facts& facts) const {
    LeafPlane plane;
    const glm::vec3 at = (facts.centre - corner_) * (65536 / edge_);
    for (int axis = 0; axis < 3; ++axis)
        plane.centre[static_cast<size_t>(axis)] = static_cast<uint16_t>(std::clamp(at[axis], 0.0f, 65535.0f));
    const uint32_t code = encode_octahedral(glm::normalize(facts.normal));
    plane.normal = static_cast<uint16_t>((code >> 8 & 0xffu) | (code >> 16 & 0xff00u));
    return plane;
}

bool GroupBuilder::join() {
    if (!joining_) begin_joining();
    Joining& own = *joining_;
    for (size_t tested = 0; own.level > 0 && tested < kJoinedAtOnce;) {
        const std::vector<Cell>& cells = levels_[own.level - 1];
        own.found.resize(cells.size());
        if (own.cell == cells.size()) {
            own.groups.level_ends.push_back(own.groups.count());
            own.finer = std::exchange(own.found, {});
            own.cell = 0;
            --own.level;
            continue;
        }
        const float edge = std::ldexp(edge_, 1 - static_cast<int>(own.level));
        tested += 1 + join_cell(cells[own.cell], edge, own.found[own.cell]);
        ++own.cell;
    }
    if (own.level > 0) return true;
    for (const Facts& facts : own.facts) own.groups.area.push_back(facts.area);
    own.groups.corner = corner_;
    own.groups.edge = edge_;
    for (const Facts& facts : facts_) own.groups.planes.push_back(plane_of(facts));
    return false;
}

}  // namespace lucarne::gi::paths
