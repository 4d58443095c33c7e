#include "gi/surfels/host_surfels.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <limits>

#include "gi/surfels/area_floor.h"
#include "gi/surfels/surfel_pool.h"
#include "io/core/parallel.h"
#include "octree/tree/footprint.h"

namespace lucarne::gi {
namespace {

/// Blocks that a thread takes at a time.
constexpr size_t kGrain = 64;

/// Own areas by code, as shares of a face of the node's cube.
std::array<float, 256> area_shares() {
    std::array<float, 256> shares;
    for (uint32_t code = 0; code < 256; ++code) shares[code] = surfel_own_area(code << 16, 1.0f);
    return shares;
}

}  // namespace

HostSurfels host_surfels(const DeviceCut& cut, std::span<const PackedSurfel> pool) {
    const auto items = cut.items();
    const auto blocks = cut.block_list();
    HostSurfels made;
    made.bounds.resize(blocks.size());
    uint32_t places = 0;
    for (const CutBlock& block : blocks) {
        made.first.push_back(places);
        places += (block.count + HostSurfels::kPadding - 1) / HostSurfels::kPadding * HostSurfels::kPadding;
    }
    made.radii.resize(
        std::max(places, HostSurfels::kPadding));  // readers of an id without a surfel read the first
    const auto shares = area_shares();
    parallel_ranges(blocks.size(), kGrain, [&](size_t first, size_t last) {
        for (size_t at = first; at < last; ++at) {
            const CutBlock& block = blocks[at];
            const CutItem& item = items[block.item];
            float* radii = made.radii.data() + made.first[at];
            glm::uvec3 low(UINT32_MAX), high(0);
            float largest = 0;
            for (uint32_t i = 0; i < block.count; ++i) {
                const PackedSurfel& surfel = pool[block.first + i];
                if (surfel_is_stray(surfel.b, surfel.d)) continue;
                if (item.clip &&
                    !cut.clip().keeps(item.origin + item.size * surfel_fractions(surfel.a, surfel.b)))
                    continue;
                const float own = item.size * item.size * shares[surfel.b >> 16 & 255u];
                const float floor =
                    item.inner ? local_floor(items, item, surfel.a, surfel.b) : item.area_floor;
                const float radius = octree::surfel_radius(own, floor);
                if (!(radius > 0)) continue;
                radii[i] = radius;
                largest = std::max(largest, radius);
                const glm::uvec3 place(surfel.a & 0xffffu, surfel.a >> 16, surfel.b & 0xffffu);
                low = glm::min(low, place);
                high = glm::max(high, place);
            }
            if (!(largest > 0)) continue;
            made.bounds[at] = {item.origin + item.size * (glm::vec3(low) + 0.5f) / kFractionSteps,
                               item.origin + item.size * (glm::vec3(high) + 0.5f) / kFractionSteps, largest};
        }
    });
    return made;
}

}  // namespace lucarne::gi
