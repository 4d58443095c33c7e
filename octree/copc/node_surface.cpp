#include "octree/copc/node_surface.h"

#include <algorithm>
#include <bit>
#include <cmath>

#include "octree/tree/area_floor.h"

namespace lucarne::octree {
namespace {

constexpr size_t kEnough = 64;  ///< number of codes that show a surface

/// Returns the codes in the node's cube.
std::span<const uint64_t> codes_in(std::span<const uint64_t> codes, const NodeKey& node) {
    const NodeKey cell = node.cell();
    const uint32_t shift = 3 * (kMaxLevel - cell.level);
    const auto begin = std::lower_bound(codes.begin(), codes.end(), cell.code() << shift),
               end = std::lower_bound(begin, codes.end(), (cell.code() + 1) << shift);
    return {begin, end};
}

/// Returns the surface that points (sorted codes) in a node's cube show. They fill cells, with four points or
/// more each. The projections of a block of 4 x 4 x 4 cells onto the three planes give the areas of the
/// surface's projections, whose squares add up to the square of its area (as they do for a plane).
double surface_shown(std::span<const uint64_t> codes, uint32_t level, double root_size) {
    constexpr uint32_t kBlockLevels = 2, kFewestPoints = 4;
    const auto shift_of = [](uint32_t depth) { return 3 * (kMaxLevel - depth); };
    const auto cells_at = [&](uint32_t depth) {
        size_t cells = 1;
        for (size_t i = 1; i < codes.size(); ++i)
            cells += codes[i] >> shift_of(depth) != codes[i - 1] >> shift_of(depth);
        return cells;
    };
    uint32_t depth = std::clamp(level + 1, kBlockLevels, kMaxLevel);
    while (depth < kMaxLevel && kFewestPoints * cells_at(depth + 1) <= codes.size()) ++depth;
    const uint32_t shift = shift_of(depth), block_shift = shift_of(depth - kBlockLevels);
    double faces = 0;  // in faces of a cell
    for (size_t i = 0; i < codes.size();) {
        const uint64_t block = codes[i] >> block_shift;
        uint16_t covered[3] = {};
        for (; i < codes.size() && codes[i] >> block_shift == block; ++i) {
            const uint64_t cell = codes[i] >> shift;
            const auto along = [&](uint32_t axis) {
                return static_cast<uint32_t>((cell >> axis & 1) | (cell >> (3 + axis) & 1) << 1);
            };
            for (uint32_t axis = 0; axis < 3; ++axis)
                covered[axis] |=
                    static_cast<uint16_t>(1u << (along((axis + 1) % 3) * 4 + along((axis + 2) % 3)));
        }
        double squares = 0;
        for (const uint16_t plane : covered) squares += std::pow(std::popcount(plane), 2);
        faces += std::sqrt(squares);
    }
    const double width = root_size * std::exp2(-static_cast<double>(depth));
    return faces * width * width;
}

}  // namespace

void set_area_floors(std::span<NodeInfo> nodes, std::span<const uint64_t> codes, double root_size) {
    std::vector<double> surfaces(nodes.size()), densities(nodes.size());
    for (size_t i = 0; i < nodes.size(); ++i) {
        NodeInfo& node = nodes[i];
        const bool root = node.parent == kNoNode;
        const auto inside = codes_in(codes, node.key);
        double surface = 0;
        if (root || inside.size() >= kEnough) {
            surface = surface_shown(inside, node.key.level, root_size);
        } else {
            const NodeInfo& parent = nodes[node.parent];
            const uint64_t below = parent.subtree_count - parent.count;
            surface = surfaces[node.parent] * static_cast<double>(node.subtree_count) /
                      static_cast<double>(std::max<uint64_t>(below, 1));
        }
        const double above = root ? 0.0 : densities[node.parent];
        const double own = surface > 0 ? node.count / surface : 0.0;
        surfaces[i] = surface;
        densities[i] = above + own;
        for (size_t step = 0; step < kPrefixSteps; ++step) {
            const double density = above + own / static_cast<double>(1u << step);
            node.area_floor[step] = density > 0 ? stored_area(1 / density) : 0.0f;
        }
    }
}

}  // namespace lucarne::octree
