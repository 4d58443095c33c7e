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
constexpr int kNoCell = kCodeBits;  ///< Range::shift of surfels at one place, and of single ones
constexpr size_t kGrain = 1024;  // nodes or surfels that one task processes
/// Sheets closer together than about this share of their size are one.
constexpr float kThinnest = 0.002f;
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

/// Gathers every third bit: the inverse of spread_bits().
uint32_t gather_bits(uint64_t v) {
    v &= 0x1249249249249249ull;
    v = (v | v >> 2) & 0x10c30c30c30c30c3ull;
    v = (v | v >> 4) & 0x100f00f00f00f00full;
    v = (v | v >> 8) & 0x1f0000ff0000ffull;
    v = (v | v >> 16) & 0x1f00000000ffffull;
    return static_cast<uint32_t>(v | v >> 32);
}

struct Box {
    glm::vec3 low{kFarAway}, high{-kFarAway};
    void add(const Box& o) {
        low = glm::min(low, o.low);
        high = glm::max(high, o.high);
    }
};

/// The cube whose cells the codes number.
struct MortonGrid {
    glm::dvec3 low{0.0};
    double step = 1;  ///< side of the smallest cells, m

    /// Returns the cell of a code, larger by a margin: neighbouring nodes do not lie in exactly one plane, and
    /// shall have no gap between them.
    Box cell(uint64_t code, int shift) const {
        constexpr double kMargin = 0.02;
        if (shift >= kNoCell) return {glm::vec3(-kFarAway), glm::vec3(kFarAway)};
        const double size = step * static_cast<double>(1u << (shift / 3));
        const uint64_t first = code >> shift << shift;
        const glm::dvec3 corner =
            low + step * glm::dvec3(gather_bits(first), gather_bits(first >> 1), gather_bits(first >> 2));
        return {glm::vec3(corner - kMargin * size), glm::vec3(corner + (1 + kMargin) * size)};
    }
};

/// Returns the surfels with discs in Morton order within their common cube.
std::vector<CodeIndex> morton_order(std::span<const FlatSurfel> surfels, MortonGrid& grid) {
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
    grid = {glm::dvec3(low), cube / ((1u << kAxisBits) - 1)};
    parallel_ranges(order.size(), kGrain, [&](size_t first, size_t last) {
        for (size_t i = first; i < last; ++i) {
            const FlatSurfel& s = surfels[order[i].index];
            const glm::dvec3 at = (glm::dvec3(s.x, s.y, s.z) - grid.low) / grid.step;
            order[i].code = spread_bits(static_cast<uint64_t>(at.x)) |
                            spread_bits(static_cast<uint64_t>(at.y)) << 1 |
                            spread_bits(static_cast<uint64_t>(at.z)) << 2;
        }
    });
    octree::sort_by_code(order, kCodeBits);
    return order;
}

/// Surfels in Morton order, of one cell of the tree: their codes are equal but for the lowest `shift` bits.
struct Range {
    size_t first = 0, last = 0;
    int shift = kNoCell;
    size_t count() const { return last - first; }
};

struct Parts {
    std::array<Range, 8> ranges;
    size_t count = 0;
    void add(const Range& range) { ranges[count++] = range; }
};

/// Divides a range of at least two surfels: into single ones if there are at most `most`, else into the
/// octants of the smallest cell that holds all. Surfels at one place are divided evenly.
Parts parts_of(std::span<const CodeIndex> order, const Range& range, size_t most) {
    Parts parts;
    if (range.count() <= most) {
        for (size_t i = range.first; i < range.last; ++i) parts.add({i, i + 1});
        return parts;
    }
    const uint64_t differing = order[range.first].code ^ order[range.last - 1].code;
    if (differing == 0) {
        for (size_t k = 0; k < 8; ++k)
            if (const size_t first = range.count() * k / 8, last = range.count() * (k + 1) / 8; last > first)
                parts.add({range.first + first, range.first + last});
        return parts;
    }
    const int shift = (std::bit_width(differing) - 1) / 3 * 3;
    for (size_t first = range.first; first < range.last;) {
        const uint64_t cell = order[first].code >> shift;
        const auto rest = order.subspan(first, range.last - first);
        const auto end = std::partition_point(rest.begin(), rest.end(), [&](const CodeIndex& item) {
            return item.code >> shift == cell;
        });
        const size_t last = first + static_cast<size_t>(end - rest.begin());
        parts.add({first, last, shift});
        first = last;
    }
    return parts;
}

/// Divides a cell into up to eight cells: its octants, and as long as there is room the octants of the one
/// with the most surfels. The cells of a flat surface are squares, which discs cover well; halves of cells
/// would not be.
Parts divide(std::span<const CodeIndex> order, const Range& range) {
    Parts children;
    children.add(range);
    for (;;) {
        const size_t room = 8 - children.count + 1;
        size_t largest = 8;
        Parts parts;
        for (size_t k = 0; k < children.count; ++k) {
            const Range& child = children.ranges[k];
            if (child.count() < 2 || (largest < 8 && child.count() <= children.ranges[largest].count()))
                continue;
            const Parts candidate = parts_of(order, child, room);
            if (candidate.count > room) continue;
            largest = k;
            parts = candidate;
        }
        if (largest == 8) return children;
        // The parts take the place of the cell, so that the children keep the Morton order.
        Parts next;
        for (size_t k = 0; k < children.count; ++k) {
            if (k != largest) next.add(children.ranges[k]);
            for (size_t p = 0; k == largest && p < parts.count; ++p) next.add(parts.ranges[p]);
        }
        children = next;
    }
}

/// Sums over a node's normals: of A n, and the symmetric matrix of A n n^T.
struct Moments {
    glm::vec3 sum{0.0f};
    float xx = 0, yy = 0, zz = 0, xy = 0, xz = 0, yz = 0;

    void add(const glm::vec3& n, float area) {
        sum += area * n;
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
    /// Returns the mean normal if most normals agree with it, as they do in the corner of a room: the front
    /// is then the inside. Else, as in a wall that was scanned from both sides, returns the axis to which the
    /// normals are closest whichever way they point (power iteration).
    glm::vec3 axis() const {
        constexpr int kIterations = 12;
        constexpr float kAgreement = 0.5f;
        if (const float agreed = glm::length(sum); agreed > kAgreement * (xx + yy + zz)) return sum / agreed;
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
    float bound = 0, thickness = 0, area = 0;
    Box box;  ///< the bounds of its discs, m
};

Summary summary_of(const FlatSurfel& s) {
    const float area = s.area > 0 && std::isfinite(s.area) ? s.area : kPi * s.radius * s.radius;
    const glm::vec3 middle(s.x, s.y, s.z), axis = decode_octahedral(s.normal);
    const glm::vec3 reach = s.radius * glm::sqrt(glm::max(glm::vec3(0.0f), 1.0f - axis * axis));
    return {middle, axis, s.radius, 0, area, {middle - reach, middle + reach}};
}

/// Returns the summary of a node whose children are complete. `areas` and `boxes` are those of its children.
Summary summary_of(const WideNode& node, const float* areas, const Box* boxes, const Moments& moments) {
    Summary sum;
    glm::vec3 middle(0.0f);
    for (size_t k = 0; k < 8; ++k) {
        if (node.child[k] == kNoChild) continue;
        middle += areas[k] * middle_of(node, k);
        sum.area += areas[k];
        sum.box.add(boxes[k]);
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
    return sum;
}

/// Sets a child; `cell`: where its surfels lie, for nodes.
void set_child(WideNode& node, size_t k, const Summary& s, const Box* cell) {
    node.x[k] = s.middle.x, node.y[k] = s.middle.y, node.z[k] = s.middle.z;
    node.nx[k] = s.axis.x, node.ny[k] = s.axis.y, node.nz[k] = s.axis.z;
    node.bound[k] = s.bound, node.thickness[k] = s.thickness, node.disc[k] = s.bound;
    glm::vec3 low(-kFarAway), high(kFarAway);
    if (cell) {
        if (s.thickness <= kThickNode * s.bound) {
            const float margin = s.thickness + kThinnest * s.bound;
            low = glm::max(s.box.low, cell->low) - s.middle - margin;
            high = glm::min(s.box.high, cell->high) - s.middle + margin;
        }
    }
    node.low_x[k] = low.x, node.low_y[k] = low.y, node.low_z[k] = low.z;
    node.high_x[k] = high.x, node.high_y[k] = high.y, node.high_z[k] = high.z;
}

WideNode empty_node() {
    WideNode node{};
    for (size_t k = 0; k < 8; ++k) {
        set_child(node, k, {.middle = glm::vec3(kFarAway)}, nullptr);
        node.child[k] = kNoChild;
    }
    return node;
}

/// Sets the topology: nodes level by level, with the surfels of their leaves. Returns the cell of every slot.
std::vector<Box> divide_all(SurfelTree& tree, std::span<const CodeIndex> order, const MortonGrid& grid) {
    std::vector<Box> cells;
    std::vector<Range> level{{0, order.size()}};
    while (!level.empty()) {
        const size_t begin = tree.nodes.size();
        tree.levels.push_back(begin);
        tree.nodes.resize(begin + level.size(), empty_node());
        tree.surfels.resize(8 * tree.nodes.size(), kNoSurfel);
        std::vector<Parts> children(level.size());
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
                cells.resize(8 * (begin + i) + k + 1);
                cells.back() = grid.cell(order[range.first].code, range.shift);
                if (leaf)
                    tree.surfels[8 * (begin + i) + k] = order[range.first].index;
                else
                    next.push_back(range);
            }
        level = std::move(next);
    }
    tree.levels.push_back(tree.nodes.size());
    cells.resize(8 * tree.nodes.size());
    return cells;
}

/// Calls body(node) for all nodes, the deepest level first.
template <class Body>
void for_each_upward(const SurfelTree& tree, const Body& body) {
    if (tree.empty()) return;
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
    const float scale = parent.thickness + kThinnest * parent.bound;
    const float outward = scale > 0 ? std::clamp(height / scale, -1.0f, 1.0f) : 0;
    const float weight = area * std::abs(cosine);
    return {weight * (1 + outward), weight * (1 - outward), cosine >= 0};
}

}  // namespace

SurfelTree build_tree(std::span<const FlatSurfel> surfels) {
    SurfelTree tree;
    MortonGrid grid;
    const std::vector<CodeIndex> order = morton_order(surfels, grid);
    tree.leaves = order.size();
    if (order.empty()) return tree;
    const std::vector<Box> cells = divide_all(tree, order, grid);
    tree.areas.resize(8 * tree.nodes.size());
    std::vector<Moments> moments(tree.nodes.size());
    std::vector<Box> boxes(tree.areas.size());
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
                child = summary_of(tree.nodes[below], &tree.areas[8 * below], &boxes[8 * below], moments[below]);
                moments[at].add(moments[below]);
            }
            set_child(node, k, child, node.child[k] == kLeafChild ? nullptr : &cells[8 * at + k]);
            tree.areas[8 * at + k] = child.area;
            boxes[8 * at + k] = child.box;
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
            const Summary parent{
                .middle = middle_of(node, k), .axis = axis_of(node, k),
                .bound = node.bound[k], .thickness = node.thickness[k]};
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
