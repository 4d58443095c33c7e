#include "octree/tree/robust_bounds.h"

#include <algorithm>
#include <cassert>
#include <cmath>
#include <functional>
#include <vector>

#include <glm/common.hpp>
#include <glm/geometric.hpp>

namespace lucarne::octree {
namespace {

/// Share of the points that may be outliers, at each end of each axis.
constexpr double kOutliers = .005;
/// The robust bounds are used where their diagonal is below this share of the whole box's; otherwise no point
/// is left out.
constexpr double kMuchSmaller = .5;
constexpr size_t kMostNodes = 1 << 13;

/// How many coarse leaves are loaded to find where their points are: such a leaf may hold them all in one
/// corner of its cube.
constexpr size_t kMostLoaded = 64;
/// Leaves from this level on are small: their cubes stand for their points.
constexpr uint32_t kFineLevel = 6;
constexpr uint32_t kPointsOfANode = 64;

/// How many steps a device resolves along the side of a node (gi::kFractionSteps), and how many steps the
/// robust bounds must span to be visible.
constexpr double kNodeSteps = 1 << 16, kLeastSteps = 256;

struct Weighted {
    glm::dvec3 low, high;
    double points;
};

struct Parts {
    std::vector<Weighted> all;
    /// The largest such step (world units) of the coarse leaves that hold more points than may be outliers.
    double coarsest = 0;
};

/// The coordinate on an axis below which `share` of the points lie.
double quantile(std::vector<Weighted>& parts, int axis, bool high, double share) {
    assert(!parts.empty());
    const auto place = [&](const Weighted& w) { return high ? w.high[axis] : w.low[axis]; };
    std::ranges::sort(parts, {}, place);
    double all = 0, below = 0;
    for (const Weighted& w : parts) all += w.points;
    for (const Weighted& w : parts)
        if ((below += w.points) > share * all) return place(w);
    return place(parts.back());
}

/// The nodes down to the deepest level that is looked at, in the order of their numbers. Those of that level
/// stand for all their descendants, so that clouds of any size are quick to measure.
struct Coarsest {
    std::vector<uint32_t> nodes;
    uint32_t level = 0;
};

Coarsest coarsest_of(const NodeSource& source, const NodeTable& nodes) {
    Coarsest found{source.roots(), 0};
    for (size_t first = 0; found.level < kMostLevel; ++found.level) {
        std::vector<uint32_t> below;
        for (size_t i = first; i < found.nodes.size() && found.nodes.size() + below.size() <= kMostNodes;
             ++i) {
            const NodeInfo node = nodes[found.nodes[i]];
            for (uint32_t octant = 0; octant < 8; ++octant)
                if (const uint32_t child = node.child(octant); child != kNoNode) below.push_back(child);
        }
        if (below.empty() || found.nodes.size() + below.size() > kMostNodes) break;
        first = found.nodes.size();
        found.nodes.insert(found.nodes.end(), below.begin(), below.end());
    }
    std::ranges::sort(found.nodes);
    return found;
}

/// Returns the parts that divide the points: the leaves, and the nodes of the deepest level with all their
/// descendants. The points of nodes above are left out: they are an even sample of space, in which outliers
/// would weigh as much as rooms.
Parts parts_of(const NodeSource& source) {
    const auto nodes = source.nodes();
    const auto [looked_at, level] = coarsest_of(source, nodes);
    std::vector<uint32_t> coarse;
    Parts parts;
    const double strays = kOutliers * static_cast<double>(source.header().points);
    const auto add_cube = [&](uint32_t i) {
        const Cube cube = source.cube(i);
        parts.all.push_back({cube.min, cube.min + cube.size, static_cast<double>(nodes[i].subtree_count)});
    };
    for (const uint32_t i : looked_at) {
        const NodeInfo node = nodes[i];
        const bool leaf = !node.child_mask;
        if (!leaf && node.key.level < level) continue;
        if (leaf && node.key.level < kFineLevel)
            coarse.push_back(i);
        else
            add_cube(i);
    }
    std::ranges::stable_sort(coarse, std::ranges::greater(), [&](uint32_t i) { return nodes[i].count; });
    for (size_t n = 0; n < coarse.size(); ++n) {
        const auto data = n < kMostLoaded ? source.load(coarse[n]) : Result<NodeData>(NodeData{});
        const uint32_t count = data ? std::min(data->count, kPointsOfANode) : 0;
        if (count == 0) add_cube(coarse[n]);
        const Cube cube = source.cube(coarse[n]);
        if (nodes[coarse[n]].count > strays)
            parts.coarsest = std::max(parts.coarsest, cube.size / kNodeSteps);
        const SourcePart part = source.part_of(coarse[n]);
        const io::Schema& schema = part.header.schema;
        for (uint32_t k = 0; k < count; ++k) {
            const glm::dvec3 p =
                io::position_of(schema, &data->records[size_t{k} * schema.stride]) * part.scale;
            // Damaged files hold coordinates that are no numbers; they cannot be sorted.
            const bool sound = std::isfinite(p.x + p.y + p.z);
            parts.all.push_back({sound ? p : cube.min, sound ? p : cube.min + cube.size,
                                 static_cast<double>(nodes[coarse[n]].count) / count});
        }
    }
    return parts;
}

}  // namespace

std::array<glm::dvec3, 2> robust_bounds(const NodeSource& source) {
    const SourceHeader& header = source.header();
    const std::array<glm::dvec3, 2> whole = {header.min, header.max};
    if (source.nodes().empty()) return whole;
    auto parts = parts_of(source);
    glm::dvec3 low, high;
    for (int axis = 0; axis < 3; ++axis) {
        low[axis] = quantile(parts.all, axis, false, kOutliers);
        high[axis] = quantile(parts.all, axis, true, 1 - kOutliers);
    }
    low = glm::max(low, header.min);
    high = glm::min(high, header.max);
    const double all = glm::length(header.max - header.min), robust = glm::length(high - low);
    const bool seen = robust >= kLeastSteps * parts.coarsest;
    return seen && robust < kMuchSmaller * all ? std::array{low, high} : whole;  // false also for NaN
}

}  // namespace lucarne::octree
