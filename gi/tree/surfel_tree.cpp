#include "gi/tree/surfel_tree.h"

#include <algorithm>
#include <cmath>

#include <glm/common.hpp>
#include <glm/geometric.hpp>
#include <glm/vector_relational.hpp>

#include "gi/shared/disc.h"
#include "gi/shared/surfel.h"
#include "gi/tree/coverage.h"
#include "gi/tree/disc_bounds.h"
#include "gi/tree/division.h"
#include "io/core/parallel.h"

namespace lucarne::gi {
namespace {

constexpr size_t kTasks = 256;  // for the nodes of a level
/// Sheets closer together than about this share of their size are one.
constexpr float kThinnest = 0.002f;
/// A node is a cloud if its thickness is over this share of its bound, and its normals agree less than this.
constexpr float kThickCloud = 0.25f, kOneSurface = 0.8f;
/// Radii of nodes that stand for nothing, so that no arithmetic on empty slots meets a NaN.
constexpr float kFarAway = 1e18f;

struct Box {
    glm::vec3 low{kFarAway}, high{-kFarAway};
    void add(const Box& o) {
        low = glm::min(low, o.low);
        high = glm::max(high, o.high);
    }
};

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

/// What a child is to its parent.
struct Summary {
    glm::vec3 middle{0.0f}, axis{0.0f, 0.0f, 1.0f};
    float bound = 0, thickness = 0, area = 0;
    Box box;                       ///< the bounds of its discs, m
    uint64_t mask = ~uint64_t{0};  ///< WideNode::mask
    bool cloud = false;
    float fill = 1;        ///< of a cloud, the share of its sphere that its discs hide
    glm::vec3 edge{0.0f};  ///< of a single disc: the line at which it ends
};

/// Sets what a surface's discs hide of its box; all of it if there are no holes and no end within `squares`.
void cover_surface(std::span<const PlacedSurfel> discs, const Box& squares, Summary& node) {
    // All discs shall be within the box if they are moved into the plane.
    const glm::vec3 margin = (node.thickness + kThinnest * node.bound) * glm::abs(node.axis);
    node.box = {node.box.low - margin, node.box.high + margin};
    Coverage coverage(largest_axis(node.axis), node.box.low, node.box.high, node.middle, node.axis);
    bool ends = false;
    for (const PlacedSurfel& disc : discs) {
        const glm::vec3 offset = disc.position - node.middle;
        ends |= disc.edge != glm::vec3(0.0f);
        coverage.add(disc.position - node.axis * glm::dot(offset, node.axis), disc.radius, node.axis,
                     disc.edge);
    }
    // Rims count where a line ends a disc beside them: at a corner its neighbours' discs would widen the box.
    const bool whole = coverage.covers([&](const glm::vec3& p) {
        if (ends) return true;
        return glm::all(glm::greaterThanEqual(p, squares.low - margin)) &&
               glm::all(glm::lessThanEqual(p, squares.high + margin));
    });
    if (!whole) node.mask = coverage.closed();
}

/// Returns the share of its sphere that a cloud hides, the mean of three directions.
float cloud_fill(std::span<const PlacedSurfel> discs, const Summary& node) {
    constexpr float kEdgeOn = 1e-3f;
    float sum = 0;
    for (int w = 0; w < 3; ++w) {
        glm::vec3 normal(0.0f);
        normal[w] = 1;
        Coverage coverage(w, node.middle - node.bound, node.middle + node.bound, node.middle, normal);
        for (const PlacedSurfel& disc : discs)
            if (std::abs(disc.normal[w]) > kEdgeOn)
                coverage.add(disc.position, disc.radius, disc.normal, disc.edge);
        sum +=
            coverage.share([&](const glm::vec3& p) { return glm::distance(p, node.middle) <= node.bound; });
    }
    return sum / 3;
}

Summary summary_of(std::span<const PlacedSurfel> discs) {
    Summary sum;
    Moments moments;
    glm::dvec3 middle(0.0);
    double area = 0;
    Box squares;  // bounds of the areas, without the rims of the discs
    for (const PlacedSurfel& disc : discs) {
        middle += glm::dvec3(disc.area * disc.position);
        area += disc.area;
        moments.add(disc.normal, disc.area);
        const DiscBounds reach = disc_bounds(disc.normal, disc.radius, disc.edge);
        sum.box.add({disc.position + reach.low, disc.position + reach.high});
        const DiscBounds half =
            disc_bounds(disc.normal, std::min(disc.radius, 0.5f * std::sqrt(disc.area)), disc.edge);
        squares.add({disc.position + half.low, disc.position + half.high});
    }
    sum.area = static_cast<float>(area);
    sum.middle = glm::vec3(middle / area);
    sum.axis = moments.axis();
    for (const PlacedSurfel& disc : discs) {
        const glm::vec3 offset = disc.position - sum.middle;
        sum.bound = std::max(sum.bound, glm::length(offset) + disc.radius);
        sum.thickness = std::max(sum.thickness, std::abs(glm::dot(offset, sum.axis)) +
                                                    disc_reach(disc.radius, glm::dot(disc.normal, sum.axis)));
    }
    sum.cloud = sum.thickness > kThickCloud * sum.bound && moments.agreement() < kOneSurface;
    if (discs.size() == 1) {
        sum.edge = discs.front().edge;
        return sum;
    }
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
    glm::vec3 low = s.edge, high(kFarAway);
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
void divide_all(SurfelTree& tree, std::span<PlacedSurfel> order) {
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
                    children[i] = divide(order, level[i], tree.levels.size() - 1);
                    for (size_t k = 0; k < children[i].count; ++k) {
                        const Range& range = children[i].ranges[k];
                        const bool leaf = range.count() == 1;
                        const Summary child = summary_of(order.subspan(range.first, range.count()));
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
    std::vector<PlacedSurfel> order = place_surfels(surfels);
    tree.leaves = order.size();
    if (!order.empty()) divide_all(tree, order);
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

std::vector<SideLight> pull_light(const SurfelTree& tree, std::span<const SideLight> light) {
    std::vector<SideLight> slots(8 * tree.nodes.size());
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
    return slots;
}

}  // namespace lucarne::gi
