#include "gi/tree/surfel_tree.h"

#include <algorithm>
#include <bit>
#include <cmath>

#include <glm/common.hpp>
#include <glm/geometric.hpp>

#include "gi/shared/brdf.h"
#include "gi/shared/surfel.h"
#include "gi/shared/surfel_code.h"
#include "io/core/parallel.h"
#include "octree/tree/radix_sort.h"

namespace lucarne::gi {
namespace {

using octree::CodeIndex;

constexpr uint32_t kAxisBits = 21, kCodeBits = 3 * kAxisBits;
constexpr size_t kGrain = 1024;  // nodes or surfels that one task processes
/// The disc of a node is this much larger than its area. With 1.15 one ray in a hundred passes between the
/// discs of a closed wall, with 1.3 one in two thousand.
constexpr float kDiscSpread = 1.3f;
/// Radii of nodes that stand for nothing, so that no arithmetic on empty slots meets a NaN.
constexpr float kFarAway = 1e18f;

glm::vec3 middle_of(const WideNode& node, size_t k) {
    return {node.x[k], node.y[k], node.z[k]};
}
glm::vec3 axis_of(const WideNode& node, size_t k) {
    return {node.nx[k], node.ny[k], node.nz[k]};
}

bool has_disc(const FlatSurfel& s) {
    return s.radius > 0 && std::isfinite(s.radius) && (s.albedo & kSurfelHasNormal) != 0 &&
           std::isfinite(s.x) && std::isfinite(s.y) && std::isfinite(s.z);
}

/// Puts two zero bits between the bits of a number of kAxisBits.
uint64_t spread_bits(uint64_t v) {
    v = (v | v << 32) & 0x1f00000000ffffull;
    v = (v | v << 16) & 0x1f0000ff0000ffull;
    v = (v | v << 8) & 0x100f00f00f00f00full;
    v = (v | v << 4) & 0x10c30c30c30c30c3ull;
    return (v | v << 2) & 0x1249249249249249ull;
}

/// Returns the surfels with discs in Morton order within their common cube.
std::vector<CodeIndex> morton_order(std::span<const FlatSurfel> surfels) {
    std::vector<CodeIndex> order;
    glm::vec3 low(kFarAway), high(-kFarAway);
    for (size_t i = 0; i < surfels.size(); ++i) {
        const FlatSurfel& s = surfels[i];
        if (!has_disc(s)) continue;
        order.push_back({0, static_cast<uint32_t>(i)});
        low = glm::min(low, glm::vec3(s.x, s.y, s.z));
        high = glm::max(high, glm::vec3(s.x, s.y, s.z));
    }
    const glm::dvec3 size = glm::dvec3(high) - glm::dvec3(low);
    const double cube = std::max({size.x, size.y, size.z, 1e-6});
    const double scale = ((1u << kAxisBits) - 1) / cube;
    parallel_ranges(order.size(), kGrain, [&](size_t first, size_t last) {
        for (size_t i = first; i < last; ++i) {
            const FlatSurfel& s = surfels[order[i].index];
            const glm::dvec3 at = (glm::dvec3(s.x, s.y, s.z) - glm::dvec3(low)) * scale;
            order[i].code = spread_bits(static_cast<uint64_t>(at.x)) |
                            spread_bits(static_cast<uint64_t>(at.y)) << 1 |
                            spread_bits(static_cast<uint64_t>(at.z)) << 2;
        }
    });
    octree::sort_by_code(order, kCodeBits);
    return order;
}

struct Range {
    size_t first = 0, last = 0;
    size_t count() const { return last - first; }
};

/// Returns where the range splits: at the highest bit in which its codes differ, in the middle if they are
/// equal.
size_t split_of(std::span<const CodeIndex> order, const Range& range) {
    const uint64_t differing = order[range.first].code ^ order[range.last - 1].code;
    if (differing == 0) return range.first + range.count() / 2;
    const uint64_t bit = std::bit_floor(differing);
    const auto part = order.subspan(range.first, range.count());
    const auto at = std::partition_point(part.begin(), part.end(),
                                         [bit](const CodeIndex& item) { return (item.code & bit) == 0; });
    return range.first + static_cast<size_t>(at - part.begin());
}

struct Children {
    std::array<Range, 8> ranges;
    size_t count = 0;
};

/// Divides a range into up to eight, always the one with the most surfels.
Children divide(std::span<const CodeIndex> order, const Range& range) {
    Children children;
    children.ranges[children.count++] = range;
    while (children.count < 8) {
        size_t largest = 0;
        for (size_t k = 1; k < children.count; ++k)
            if (children.ranges[k].count() > children.ranges[largest].count()) largest = k;
        Range& split = children.ranges[largest];
        if (split.count() < 2) break;
        const size_t at = split_of(order, split);
        const Range upper{at, split.last};
        split.last = at;
        // The new range stands behind its other half, so that the children keep the Morton order.
        for (size_t k = children.count; k > largest + 1; --k) children.ranges[k] = children.ranges[k - 1];
        children.ranges[largest + 1] = upper;
        ++children.count;
    }
    return children;
}

/// The symmetric matrix sum A n n^T of a node's normals.
struct Moments {
    float xx = 0, yy = 0, zz = 0, xy = 0, xz = 0, yz = 0;

    void add(const glm::vec3& n, float area) {
        xx += area * n.x * n.x;
        yy += area * n.y * n.y;
        zz += area * n.z * n.z;
        xy += area * n.x * n.y;
        xz += area * n.x * n.z;
        yz += area * n.y * n.z;
    }
    void add(const Moments& o) { xx += o.xx, yy += o.yy, zz += o.zz, xy += o.xy, xz += o.xz, yz += o.yz; }
    glm::vec3 times(const glm::vec3& v) const {
        return {xx * v.x + xy * v.y + xz * v.z, xy * v.x + yy * v.y + yz * v.z,
                xz * v.x + yz * v.y + zz * v.z};
    }
    /// Returns the axis to which the normals are closest, whichever way they point (power iteration).
    glm::vec3 axis() const {
        constexpr int kIterations = 12;
        glm::vec3 v = xx >= yy && xx >= zz ? glm::vec3(xx, xy, xz)
                      : yy >= zz           ? glm::vec3(xy, yy, yz)
                                           : glm::vec3(xz, yz, zz);
        for (int i = 0; i < kIterations; ++i) {
            const float length = glm::length(v);
            if (!(length > 0)) return {0, 0, 1};
            v = times(v / length);
        }
        const float length = glm::length(v);
        return length > 0 ? v / length : glm::vec3(0, 0, 1);
    }
};

/// What a child is to its parent.
struct Summary {
    glm::vec3 middle{0.0f}, axis{0.0f, 0.0f, 1.0f};
    float bound = 0, disc = 0, thickness = 0, area = 0;
};

Summary summary_of(const FlatSurfel& s) {
    const float area = s.area > 0 && std::isfinite(s.area) ? s.area : kPi * s.radius * s.radius;
    return {{s.x, s.y, s.z}, decode_octahedral(s.normal), s.radius, s.radius, 0, area};
}

/// Returns the summary of a node whose children are complete.
Summary summary_of(const WideNode& node, const float* areas, const Moments& moments) {
    Summary sum;
    glm::vec3 middle(0.0f);
    for (size_t k = 0; k < 8; ++k) {
        if (node.child[k] == kNoChild) continue;
        middle += areas[k] * middle_of(node, k);
        sum.area += areas[k];
    }
    sum.middle = middle / sum.area;
    sum.axis = moments.axis();
    for (size_t k = 0; k < 8; ++k) {
        if (node.child[k] == kNoChild) continue;
        const glm::vec3 offset = middle_of(node, k) - sum.middle;
        const float cosine = glm::dot(axis_of(node, k), sum.axis);
        sum.bound = std::max(sum.bound, glm::length(offset) + node.bound[k]);
        const float tilt = node.bound[k] * std::sqrt(std::max(0.0f, 1 - cosine * cosine));
        sum.thickness = std::max(sum.thickness, std::abs(glm::dot(offset, sum.axis)) +
                                                    std::min(node.bound[k], tilt + node.thickness[k]));
    }
    sum.thickness = std::min(sum.thickness, sum.bound);
    sum.disc = std::min(sum.bound, kDiscSpread * std::sqrt(sum.area / kPi));
    return sum;
}

void set_child(WideNode& node, size_t k, const Summary& s) {
    node.x[k] = s.middle.x, node.y[k] = s.middle.y, node.z[k] = s.middle.z;
    node.nx[k] = s.axis.x, node.ny[k] = s.axis.y, node.nz[k] = s.axis.z;
    node.bound[k] = s.bound, node.disc[k] = s.disc, node.thickness[k] = s.thickness;
}

WideNode empty_node() {
    WideNode node{};
    for (size_t k = 0; k < 8; ++k) {
        set_child(node, k, {glm::vec3(kFarAway), {0, 0, 1}, 0, 0, 0, 0});
        node.child[k] = kNoChild;
    }
    return node;
}

/// Sets the topology: nodes level by level, with the surfels of their leaves.
void divide_all(SurfelTree& tree, std::span<const CodeIndex> order) {
    std::vector<Range> level{{0, order.size()}};
    while (!level.empty()) {
        const size_t begin = tree.nodes.size();
        tree.levels.push_back(begin);
        tree.nodes.resize(begin + level.size(), empty_node());
        tree.surfels.resize(8 * tree.nodes.size(), kNoSurfel);
        std::vector<Children> children(level.size());
        parallel_ranges(level.size(), kGrain, [&](size_t first, size_t last) {
            for (size_t i = first; i < last; ++i) children[i] = divide(order, level[i]);
        });
        std::vector<Range> next;
        for (size_t i = 0; i < level.size(); ++i)
            for (size_t k = 0; k < children[i].count; ++k) {
                const Range& range = children[i].ranges[k];
                const bool leaf = range.count() == 1;
                tree.nodes[begin + i].child[k] =
                    leaf ? kLeafChild : static_cast<int>(begin + level.size() + next.size());
                if (leaf)
                    tree.surfels[8 * (begin + i) + k] = order[range.first].index;
                else
                    next.push_back(range);
            }
        level = std::move(next);
    }
    tree.levels.push_back(tree.nodes.size());
}

/// Calls body(node) for all nodes, the deepest level first.
template <class Body>
void for_each_upward(const SurfelTree& tree, const Body& body) {
    for (size_t level = tree.levels.size() - 1; level-- > 0;) {
        const size_t begin = tree.levels[level], end = tree.levels[level + 1];
        parallel_ranges(end - begin, kGrain, [&](size_t first, size_t last) {
            for (size_t i = begin + first; i < begin + last; ++i) body(i);
        });
    }
}

/// Returns how much a child counts on the two sides of its parent's disc, and whether its own front is on
/// the parent's front.
struct Facing {
    float front, back;
    bool same;
};
Facing facing(const WideNode& node, size_t k, float area, const Summary& parent) {
    const float cosine = glm::dot(axis_of(node, k), parent.axis);
    const float height = glm::dot(middle_of(node, k) - parent.middle, parent.axis);
    const float outward = parent.thickness > 0 ? std::clamp(height / parent.thickness, -1.0f, 1.0f) : 0;
    const float weight = area * std::abs(cosine);
    return {weight * (1 + outward), weight * (1 - outward), cosine >= 0};
}

}  // namespace

SurfelTree build_tree(std::span<const FlatSurfel> surfels) {
    SurfelTree tree;
    const std::vector<CodeIndex> order = morton_order(surfels);
    tree.leaves = order.size();
    if (order.empty()) return tree;
    divide_all(tree, order);
    tree.areas.resize(8 * tree.nodes.size());
    std::vector<Moments> moments(tree.nodes.size());
    for_each_upward(tree, [&](size_t at) {
        WideNode& node = tree.nodes[at];
        for (size_t k = 0; k < 8; ++k) {
            if (node.child[k] == kNoChild) continue;
            Summary child;
            if (node.child[k] == kLeafChild) {
                child = summary_of(surfels[tree.surfels[8 * at + k]]);
                moments[at].add(child.axis, child.area);
            } else {
                const auto below = static_cast<size_t>(node.child[k]);
                child = summary_of(tree.nodes[below], &tree.areas[8 * below], moments[below]);
                moments[at].add(moments[below]);
            }
            set_child(node, k, child);
            tree.areas[8 * at + k] = child.area;
        }
    });
    return tree;
}

void pull_light(const SurfelTree& tree, std::span<const SideLight> light, std::vector<SideLight>& slots) {
    slots.assign(8 * tree.nodes.size(), {});
    for_each_upward(tree, [&](size_t at) {
        const WideNode& node = tree.nodes[at];
        for (size_t k = 0; k < 8; ++k) {
            if (node.child[k] == kLeafChild) slots[8 * at + k] = light[tree.surfels[8 * at + k]];
            if (node.child[k] < 0) continue;
            const auto below = static_cast<size_t>(node.child[k]);
            const WideNode& inner = tree.nodes[below];
            const Summary parent{middle_of(node, k), axis_of(node, k), 0, 0, node.thickness[k], 0};
            SideLight sum;
            float front = 0, back = 0;
            for (size_t c = 0; c < 8; ++c) {
                if (inner.child[c] == kNoChild) continue;
                const Facing share = facing(inner, c, tree.areas[8 * below + c], parent);
                const SideLight& own = slots[8 * below + c];
                sum.front += share.front * (share.same ? own.front : own.back);
                sum.back += share.back * (share.same ? own.back : own.front);
                front += share.front, back += share.back;
            }
            if (front > 0) sum.front /= front;
            if (back > 0) sum.back /= back;
            slots[8 * at + k] = sum;
        }
    });
}

}  // namespace lucarne::gi
