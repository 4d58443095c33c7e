#include "octree/copc/node_order.h"

#include <algorithm>

#include "octree/convert/sampling/node_sampler.h"
#include "octree/convert/sampling/sampler.h"
#include "octree/tree/radix_sort.h"

namespace lucarne::octree {

std::vector<uint32_t> even_order(const NodeKey& node, std::span<const Place> places) {
    const NodeKey cell = node.cell();
    const auto clamped = [&](uint32_t v, uint32_t c) {
        const uint64_t low = uint64_t{c} << (32 - cell.level), high = (uint64_t{c} + 1) << (32 - cell.level);
        return static_cast<uint32_t>(std::clamp<uint64_t>(v, low, high - 1));
    };
    const auto inside = [&](const Place& p) {
        return Place{clamped(p.x, cell.x), clamped(p.y, cell.y), clamped(p.z, cell.z)};
    };
    std::vector<CodeIndex> curve(places.size());
    for (uint32_t i = 0; i < curve.size(); ++i) curve[i] = {inside(places[i]).code(), i};
    sort_by_code(curve, 3 * (kMaxLevel - cell.level));
    Sampler sampler;
    sampler.start(node);
    for (const CodeIndex& item : curve) sampler.add(inside(places[item.index]));
    sampler.run(kRootSpacing, sampler.size());
    std::vector<uint32_t> order;
    order.reserve(curve.size());
    append_prefix_order(sampler.passes(), 0, order);
    for (uint32_t& i : order) i = curve[i].index;
    return order;
}

}  // namespace lucarne::octree
