#include "gi/tree/surfel_tree.h"

#include <algorithm>
#include <bit>
#include <cmath>

#include <glm/common.hpp>
#include <glm/geometric.hpp>
#include <glm/vector_relational.hpp>

#include "gi/shared/brdf.h"
#include "gi/shared/disc.h"
#include "gi/shared/surfel.h"
#include "gi/shared/surfel_code.h"
#include "gi/tree/coverage.h"
#include "io/core/parallel.h"
#include "octree/tree/radix_sort.h"

namespace lucarne::gi {
namespace {

using octree::CodeIndex;

constexpr uint32_t kAxisBits = 20, kMortonBits = 3 * kAxisBits, kCodeBits = kMortonBits + 3;
constexpr size_t kTasks = 256;   // for the nodes of a level
constexpr size_t kGrain = 1024;  // nodes or surfels that one task processes
/// Sheets closer together than about this share of their size are one.
constexpr float kThinnest = 0.002f;
/// A flat node is drawn whole if its surfels cover nearly all of it; else it has holes, or the end of its
/// surface. Where points are not even, shares of few of them vary.
constexpr float kFilled = 0.92f, kUneven = 0.4f;
/// A node is a cloud if its thickness is over this share of its bound, and its normals agree less than this.
constexpr float kThickCloud = 0.25f, kOneSurface = 0.8f;
/// Radii of nodes that stand for nothing, so that no arithmetic on empty slots meets a NaN.
constexpr float kFarAway = 1e18f;

bool has_disc(const FlatSurfel& s) {
    return s.radius > 0 && std::isfinite(s.radius) && (s.albedo & kSurfelHasNormal) != 0 &&
           std::isfinite(s.x) && std::isfinite(s.y) && std::isfinite(s.z);
}

/// Returns which side of a cube a normal is nearest to: 0 to 5.
uint64_t side_of(const glm::vec3& n) {
    const glm::vec3 size = glm::abs(n);
    const int axis = size.x >= size.y && size.x >= size.z ? 0 : size.y >= size.z ? 1 : 2;
    return static_cast<uint64_t>(2 * axis + (n[axis] < 0));
}

/// Puts two zero bits between the bits of a number of kAxisBits.
uint64_t spread_bits(uint64_t v) {
    v = (v | v << 32) & 0x1f00000000ffffull;
    v = (v | v << 16) & 0x1f0000ff0000ffull;
    v = (v | v << 8) & 0x100f00f00f00f00full;
    v = (v | v << 4) & 0x10c30c30c30c30c3ull;
    return (v | v << 2) & 0x1249249249249249ull;
}

struct Box {
    glm::vec3 low{kFarAway}, high{-kFarAway};
    void add(const Box& o) {
        low = glm::min(low, o.low);
        high = glm::max(high, o.high);
    }
};

/// Returns the surfels with discs in the order of their codes: the side of a cube to which the normal is
/// nearest, then the Morton code of the position within the common cube. Thus surfaces of several directions
/// share no node but the root. A node of the edge of a box would have no plane, and the light of both sides
/// would be seen from either.
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
            order[i].code = side_of(decode_octahedral(s.normal)) << kMortonBits |
                            spread_bits(static_cast<uint64_t>(at.x)) |
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
        const auto end = std::partition_point(
            rest.begin(), rest.end(), [&](const CodeIndex& item) { return item.code >> shift == cell; });
        const size_t last = first + static_cast<size_t>(end - rest.begin());
        parts.add({first, last});
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
    glm::vec3 times(const glm::vec3& v) const {
        return {xx * v.x + xy * v.y + xz * v.z, xy * v.x + yy * v.y + yz * v.z,
                xz * v.x + yz * v.y + zz * v.z};
    }
    /// Returns how much the normals agree: 1 if they are parallel, 0 if they point everywhere.
    float agreement() const { return glm::length(sum) / (xx + yy + zz); }
    /// Returns the mean normal if most normals agree with it, as they do in the corner of a room: the front
    /// is then the inside. Else, as in a wall that was scanned from both sides, returns the axis to which the
    /// normals are closest whichever way they point (power iteration).
    glm::vec3 axis() const {
        constexpr int kIterations = 12;
        constexpr float kAgreement = 0.5f;
        if (agreement() > kAgreement) return glm::normalize(sum);
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

/// A decoded surfel.
struct Disc {
    glm::vec3 middle, normal;
    float radius, area;
};

Disc disc_of(const FlatSurfel& s) {
    const float area = s.area > 0 && std::isfinite(s.area) ? s.area : kPi * s.radius * s.radius;
    return {{s.x, s.y, s.z}, decode_octahedral(s.normal), s.radius, area};
}

/// What a child is to its parent.
struct Summary {
    glm::vec3 middle{0.0f}, axis{0.0f, 0.0f, 1.0f};
    float bound = 0, thickness = 0, area = 0;
    Box box;                       ///< the bounds of its discs, m
    uint64_t mask = ~uint64_t{0};  ///< WideNode::mask
    bool cloud = false;
    float fill = 1;  ///< of a cloud, the share of its sphere that its discs hide
};

/// Sets what a surface's discs hide of its box; all of it if there are no holes and no end within `squares`.
void cover_surface(std::span<const Disc> discs, const Box& squares, Summary& node) {
    // All discs shall be within the box if they are moved into the plane.
    const glm::vec3 margin = (node.thickness + kThinnest * node.bound) * glm::abs(node.axis);
    node.box = {node.box.low - margin, node.box.high + margin};
    Coverage coverage(largest_axis(node.axis), node.box.low, node.box.high, node.middle, node.axis);
    for (const Disc& disc : discs) {
        const glm::vec3 offset = disc.middle - node.middle;
        coverage.add(disc.middle - node.axis * glm::dot(offset, node.axis), disc.radius, node.axis);
    }
    const float uneven = kUneven / std::sqrt(static_cast<float>(discs.size()));
    const float filled = coverage.share([&](const glm::vec3& p) {
        return glm::all(glm::greaterThanEqual(p, squares.low - margin)) &&
               glm::all(glm::lessThanEqual(p, squares.high + margin));
    });
    if (filled < kFilled - uneven) node.mask = coverage.covered();
}

/// Returns the share of its sphere that a cloud hides, the mean of three directions.
float cloud_fill(std::span<const Disc> discs, const Summary& node) {
    constexpr float kEdgeOn = 1e-3f;
    float sum = 0;
    for (int w = 0; w < 3; ++w) {
        glm::vec3 normal(0.0f);
        normal[w] = 1;
        Coverage coverage(w, node.middle - node.bound, node.middle + node.bound, node.middle, normal);
        for (const Disc& disc : discs)
            if (std::abs(disc.normal[w]) > kEdgeOn) coverage.add(disc.middle, disc.radius, disc.normal);
        sum +=
            coverage.share([&](const glm::vec3& p) { return glm::distance(p, node.middle) <= node.bound; });
    }
    return sum / 3;
}

Summary summary_of(std::span<const Disc> discs) {
    Summary sum;
    Moments moments;
    glm::dvec3 middle(0.0);
    double area = 0;
    Box squares;  // bounds of the areas, without the rims of the discs
    for (const Disc& disc : discs) {
        middle += glm::dvec3(disc.area * disc.middle);
        area += disc.area;
        moments.add(disc.normal, disc.area);
        const glm::vec3 reach =
            disc.radius * glm::sqrt(glm::max(glm::vec3(0.0f), 1.0f - disc.normal * disc.normal));
        sum.box.add({disc.middle - reach, disc.middle + reach});
        const glm::vec3 half = reach * std::min(1.0f, 0.5f * std::sqrt(disc.area) / disc.radius);
        squares.add({disc.middle - half, disc.middle + half});
    }
    sum.area = static_cast<float>(area);
    sum.middle = glm::vec3(middle / area);
    sum.axis = moments.axis();
    for (const Disc& disc : discs) {
        const glm::vec3 offset = disc.middle - sum.middle;
        sum.bound = std::max(sum.bound, glm::length(offset) + disc.radius);
        sum.thickness = std::max(sum.thickness, std::abs(glm::dot(offset, sum.axis)) +
                                                    disc_reach(disc.radius, glm::dot(disc.normal, sum.axis)));
    }
    sum.cloud = sum.thickness > kThickCloud * sum.bound && moments.agreement() < kOneSurface;
    if (discs.size() == 1) return sum;
    if (sum.cloud)
        sum.fill = cloud_fill(discs, sum);
    else
        cover_surface(discs, squares, sum);
    return sum;
}

void set_child(WideNode& node, size_t k, const Summary& s, bool leaf) {
    node.x[k] = s.middle.x, node.y[k] = s.middle.y, node.z[k] = s.middle.z;
    node.nx[k] = s.axis.x, node.ny[k] = s.axis.y, node.nz[k] = s.axis.z;
    node.bound[k] = s.bound, node.thickness[k] = s.thickness;
    node.mask_low[k] = static_cast<uint32_t>(s.mask);
    node.mask_high[k] = static_cast<uint32_t>(s.mask >> 32);
    glm::vec3 low(-kFarAway), high(kFarAway);
    if (s.cloud && !leaf) {
        low.x = s.fill;
        high.x = kCloud;
    } else if (!leaf) {
        low = s.box.low - s.middle;
        high = s.box.high - s.middle;
    }
    node.low_x[k] = low.x, node.low_y[k] = low.y, node.low_z[k] = low.z;
    node.high_x[k] = high.x, node.high_y[k] = high.y, node.high_z[k] = high.z;
}

/// Sets the nodes, level by level.
void divide_all(SurfelTree& tree, std::span<const CodeIndex> order, std::span<const Disc> discs) {
    std::vector<Range> level{{0, order.size()}};
    while (!level.empty()) {
        const size_t begin = tree.nodes.size();
        tree.levels.push_back(begin);
        tree.nodes.resize(begin + level.size(), empty_node());
        tree.surfels.resize(8 * tree.nodes.size(), kNoSurfel);
        tree.areas.resize(8 * tree.nodes.size());
        std::vector<Parts> children(level.size());
        parallel_ranges(
            level.size(), std::max<size_t>(1, level.size() / kTasks), [&](size_t first, size_t last) {
                for (size_t i = first; i < last; ++i) {
                    children[i] = divide(order, level[i]);
                    for (size_t k = 0; k < children[i].count; ++k) {
                        const Range& range = children[i].ranges[k];
                        const bool leaf = range.count() == 1;
                        const Summary child = summary_of(discs.subspan(range.first, range.count()));
                        WideNode& node = tree.nodes[begin + i];
                        set_child(node, k, child, leaf);
                        node.child[k] = kLeafChild;  // nodes get their numbers below
                        tree.areas[8 * (begin + i) + k] = child.area;
                        if (leaf) tree.surfels[8 * (begin + i) + k] = order[range.first].index;
                    }
                }
            });
        std::vector<Range> next;
        for (size_t i = 0; i < level.size(); ++i)
            for (size_t k = 0; k < children[i].count; ++k) {
                if (children[i].ranges[k].count() == 1) continue;
                tree.nodes[begin + i].child[k] = static_cast<int>(begin + level.size() + next.size());
                next.push_back(children[i].ranges[k]);
            }
        level = std::move(next);
    }
    tree.levels.push_back(tree.nodes.size());
}

}  // namespace

WideNode empty_node() {
    WideNode node{};
    for (size_t k = 0; k < 8; ++k) {
        set_child(node, k, {.middle = glm::vec3(kFarAway)}, true);
        node.child[k] = kNoChild;
    }
    return node;
}

SurfelTree build_tree(std::span<const FlatSurfel> surfels) {
    SurfelTree tree;
    const std::vector<CodeIndex> order = morton_order(surfels);
    tree.leaves = order.size();
    if (order.empty()) return tree;
    std::vector<Disc> discs(order.size());
    parallel_ranges(order.size(), kGrain, [&](size_t first, size_t last) {
        for (size_t i = first; i < last; ++i) discs[i] = disc_of(surfels[order[i].index]);
    });
    divide_all(tree, order, discs);
    return tree;
}

Facing facing(const SurfelTree& tree, size_t parent, size_t child) {
    const WideNode &outer = tree.nodes[parent / 8], &inner = tree.nodes[child / 8];
    const size_t p = parent % 8, c = child % 8;
    const glm::vec3 axis = axis_of(outer, p);
    const float cosine = glm::dot(axis_of(inner, c), axis);
    const float height = glm::dot(middle_of(inner, c) - middle_of(outer, p), axis);
    const float scale = outer.thickness[p] + kThinnest * outer.bound[p];
    const float outward = scale > 0 ? std::clamp(height / scale, -1.0f, 1.0f) : 0;
    const float weight = tree.areas[child] * std::abs(cosine);
    return {weight * (1 + outward), weight * (1 - outward), cosine >= 0};
}

void pull_light(const SurfelTree& tree, std::span<const SideLight> light, std::vector<SideLight>& slots) {
    slots.assign(8 * tree.nodes.size(), {});
    for_each_upward(tree, [&](size_t at) {
        const WideNode& node = tree.nodes[at];
        for (size_t k = 0; k < 8; ++k) {
            const size_t slot = 8 * at + k;
            if (node.child[k] == kLeafChild) slots[slot] = light[tree.surfels[slot]];
            SideLight sum;
            float front = 0, back = 0;
            for_each_child(tree, slot, [&](size_t child) {
                const Facing share = facing(tree, slot, child);
                const SideLight& own = slots[child];
                sum.front += share.front * (share.same ? own.front : own.back);
                sum.back += share.back * (share.same ? own.back : own.front);
                front += share.front, back += share.back;
            });
            if (node.child[k] < 0) continue;
            if (front > 0) sum.front /= front;
            if (back > 0) sum.back /= back;
            slots[slot] = sum;
        }
    });
}

}  // namespace lucarne::gi
