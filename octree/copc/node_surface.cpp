#include "octree/copc/node_surface.h"

#include <algorithm>
#include <cmath>

#include "octree/build/subtree.h"

namespace lucarne::octree {
namespace {

constexpr size_t kEnough = 64;  ///< codes that show a surface

/// Those in the node's cube.
std::span<const uint64_t> codes_in(std::span<const uint64_t> codes, const NodeKey& node) {
    const NodeKey cell = node.cell();
    const uint32_t shift = 3 * (kMaxLevel - cell.level);
    const auto begin = std::lower_bound(codes.begin(), codes.end(), cell.code() << shift),
               end = std::lower_bound(begin, codes.end(), (cell.code() + 1) << shift);
    return {begin, end};
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
            const std::vector<float> unknown(inside.size(), 0.0f);
            surface = surface_of(unknown, inside, node.key.level, root_size);
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
            node.area_floor[step] = density > 0 ? static_cast<float>(1 / density) : 0.0f;
        }
    }
}

}  // namespace lucarne::octree
