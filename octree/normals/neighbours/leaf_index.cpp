#include "octree/normals/neighbours/leaf_index.h"

#include <algorithm>
#include <bit>
#include <cmath>
#include <limits>
#include <numeric>

#include <glm/common.hpp>

#include "octree/tree/key.h"
#include "octree/tree/radix_sort.h"

namespace lucarne::octree {
namespace {

constexpr uint32_t kLeafPoints = 24;  ///< most points in a leaf; 16 is typical
/// A search for at most so many points gives up where it meets this share of them in nodes over leaves: in
/// surroundings that are too crowded it then costs no more than copying the points.
constexpr size_t kLeastOfNode = 4;
/// Floats that are rounded, subtracted, squared and added are off by less than this share.
constexpr double kMoreThanSquared = 1 + 1e-5;
constexpr float kLessThanSquared = 1 - 1e-5f;

/// Computes Morton codes of positions within bounds, 21 bits an axis.
struct MortonGrid {
    glm::dvec3 low;
    double scale;

    explicit MortonGrid(const Box& box) : low(box.min) {
        const glm::dvec3 size = box.max - box.min;
        scale = 2097151.0 / std::max({size.x, size.y, size.z, 1e-290});
    }
    uint64_t code(const glm::dvec3& p) const {
        const glm::dvec3 cell = (p - low) * scale;
        return morton(static_cast<uint64_t>(cell.x), static_cast<uint64_t>(cell.y),
                      static_cast<uint64_t>(cell.z));
    }
};

template <class Points>
Box bounds_of_all(const Points& points) {
    Box box{glm::dvec3(kInfinity), glm::dvec3(-kInfinity)};
    for (size_t i = 0; i < points.size(); ++i) {
        box.min = glm::min(box.min, points[i]);
        box.max = glm::max(box.max, points[i]);
    }
    return box;
}

bool less(const glm::dvec3& a, const glm::dvec3& b) {
    return a.x != b.x ? a.x < b.x : a.y != b.y ? a.y < b.y : a.z < b.z;
}

}  // namespace

std::vector<uint32_t> morton_order(std::span<const glm::dvec3> points) {
    const MortonGrid grid(bounds_of_all(points));
    std::vector<CodeIndex> keys(points.size());
    for (size_t i = 0; i < points.size(); ++i) keys[i] = {grid.code(points[i]), static_cast<uint32_t>(i)};
    sort_by_code(keys, 3 * kMaxLevel);
    std::vector<uint32_t> order(points.size());
    for (size_t first = 0, last; first < keys.size(); first = last) {
        for (last = first; last < keys.size() && keys[last].code == keys[first].code; ++last)
            order[last] = keys[last].index;
        std::stable_sort(order.begin() + static_cast<ptrdiff_t>(first),
                         order.begin() + static_cast<ptrdiff_t>(last),
                         [&](uint32_t a, uint32_t b) { return less(points[a], points[b]); });
    }
    return order;
}

LeafIndex::LeafIndex(const PointArrays& points) : points_(&points) {
    const Box bounds = bounds_of_all(points);
    centre_ = (bounds.min + bounds.max) * 0.5;
    const MortonGrid grid(bounds);
    std::vector<uint64_t> codes(points.size());
    for (size_t i = 0; i < points.size(); ++i) codes[i] = grid.code(points[i]);
    cut(0, static_cast<uint32_t>(points.size()), codes);
    first_.push_back(static_cast<uint32_t>(points.size()));
    build_tree();
}

/// Halves the cell that contains the points [first, last) until few points are left. If all are in the same
/// finest cell, halves the range of points instead.
void LeafIndex::cut(uint32_t first, uint32_t last, std::span<const uint64_t> codes) {
    if (last - first <= kLeafPoints) {
        if (last > first) first_.push_back(first);
        return;
    }
    const uint64_t differ = codes[first] ^ codes[last - 1];
    uint32_t middle = first + (last - first) / 2;
    if (differ != 0) {
        const uint64_t bit = std::bit_floor(differ), upper = (codes[last - 1] & ~(bit - 1));
        middle = static_cast<uint32_t>(std::lower_bound(codes.begin() + first, codes.begin() + last, upper) -
                                       codes.begin());
    }
    cut(first, middle, codes);
    cut(middle, last, codes);
}

Box LeafIndex::bounds_of_leaf(size_t leaf) const {
    Box box{glm::dvec3(kInfinity), glm::dvec3(-kInfinity)};
    for (uint32_t i = first_[leaf]; i < first_[leaf + 1]; ++i) {
        box.min = glm::min(box.min, (*points_)[i]);
        box.max = glm::max(box.max, (*points_)[i]);
    }
    return box;
}

/// Returns a corner relative to the centre as floats, moved by more than their rounding: up, if `outward` is
/// 1, or down, if it is -1.
glm::vec3 LeafIndex::relative(const glm::dvec3& p, float outward) const {
    constexpr float kRounding = 0x1p-22f;
    const glm::vec3 v(p - centre_);
    return v + outward * kRounding * glm::abs(v);
}

void LeafIndex::build_tree() {
    constexpr float kFar = std::numeric_limits<float>::infinity();
    size_t count = first_.size() - 1;
    do {
        std::vector<Node> level((count + kFan - 1) / kFan);
        for (size_t i = 0; i < level.size() * kFan; ++i) {
            glm::vec3 low(kFar), high(-kFar);
            if (i < count && levels_.empty()) {
                const Box box = bounds_of_leaf(i);
                low = relative(box.min, -1);
                high = relative(box.max, 1);
            } else if (i < count) {
                const Node& node = levels_.back()[i];
                for (int axis = 0; axis < 3; ++axis) {
                    low[axis] = *std::min_element(node.low[static_cast<size_t>(axis)].begin(),
                                                  node.low[static_cast<size_t>(axis)].end());
                    high[axis] = *std::max_element(node.high[static_cast<size_t>(axis)].begin(),
                                                   node.high[static_cast<size_t>(axis)].end());
                }
            }
            for (int axis = 0; axis < 3; ++axis) {
                level[i / kFan].low[static_cast<size_t>(axis)][i % kFan] = low[axis];
                level[i / kFan].high[static_cast<size_t>(axis)][i % kFan] = high[axis];
            }
        }
        count = level.size();
        levels_.push_back(std::move(level));
    } while (count > 1);
}

bool LeafIndex::gather(const Box& box, double radius, uint32_t offset, size_t most, Tile& tile) const {
    const glm::vec3 low(box.min - tile.origin), high(box.max - tile.origin);
    const auto limit2 = static_cast<float>(
        std::min(radius * radius * kMoreThanSquared, double{std::numeric_limits<float>::max()}));
    const Vicinity vicinity{relative(box.min, -1), relative(box.max, 1), limit2};
    std::vector<uint32_t>&nodes = tile.nodes, &children = tile.children;
    nodes.assign(1, 0);
    for (size_t level = levels_.size(); --level > 0;) {
        children.resize(std::max(children.size(), (nodes.size() + 1) * kFan));
        const size_t count =
            children_within(levels_[level], nodes.data(), nodes.size(), vicinity, children.data());
        if (count > most / kLeastOfNode) return false;
        nodes.assign(children.begin(), children.begin() + static_cast<ptrdiff_t>(count));
    }
    std::array<uint32_t, 2 * kFan> leaves;
    for (const uint32_t node : nodes) {
        const size_t count = children_within(levels_[0], &node, 1, vicinity, leaves.data());
        for (size_t i = 0, end; i < count; i = end) {
            for (end = i + 1; end < count && leaves[end] == leaves[end - 1] + 1;) ++end;
            tile.append(*points_, first_[leaves[i]], first_[leaves[end - 1] + 1], offset, low, high, limit2);
        }
        if (tile.count > most) return false;
    }
    return true;
}

/// Searches depth first, the nearest box first (Roussopoulos, Kelley, Vincent 1995).
size_t LeafIndex::merge_nearest(const glm::dvec3& query, std::span<Neighbour> nearest, size_t found,
                                uint32_t offset) const {
    if (nearest.empty()) return found;
    const auto worst = [&] { return found < nearest.size() ? kInfinity : nearest.back().distance2; };
    const auto take = [&](double d2, uint32_t index) {
        if (!(d2 < worst())) return;
        if (found < nearest.size()) ++found;
        size_t at = found - 1;
        for (; at > 0 && nearest[at - 1].distance2 > d2; --at) nearest[at] = nearest[at - 1];
        nearest[at] = {d2, index};
    };
    const glm::vec3 low = relative(query, -1), high = relative(query, 1);
    std::array<Step, kMostSteps> stack;
    size_t waiting = 0;
    stack[waiting++] = {0, static_cast<uint32_t>(levels_.size()), 0};
    std::array<float, kFan> distance2;
    while (waiting > 0) {
        const Step step = stack[--waiting];
        if (step.distance2 >= worst()) continue;
        if (step.level == 0) {
            for (uint32_t i = first_[step.node]; i < first_[step.node + 1]; ++i) {
                const glm::dvec3 d = (*points_)[i] - query;
                take(d.x * d.x + d.y * d.y + d.z * d.z, i + offset);
            }
            continue;
        }
        distances_of(levels_[step.level - 1][step.node], low, high, distance2);
        for (float& d2 : distance2) d2 = d2 * kLessThanSquared - std::numeric_limits<float>::min();
        const size_t below = waiting;
        for (size_t i = kFan; i-- > 0;) {
            if (!(distance2[i] < worst())) continue;
            size_t at = waiting++;
            for (; at > below && stack[at - 1].distance2 < distance2[i]; --at) stack[at] = stack[at - 1];
            stack[at] = {distance2[i], step.level - 1, static_cast<uint32_t>(step.node * kFan + i)};
        }
    }
    return found;
}

std::unique_ptr<PointIndex> make_index(NeighbourSearch search, const PointArrays& points) {
    if (points.size() == 0) return nullptr;
    if (search == NeighbourSearch::flann) return make_flann_index(points);
    return std::make_unique<LeafIndex>(points);
}

}  // namespace lucarne::octree
