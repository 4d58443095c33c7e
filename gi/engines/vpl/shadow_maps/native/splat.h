#pragma once

#include <cstdint>
#include <span>

#include "gi/engines/vpl/vpl_light.h"

namespace lucarne::gi::vpl::native {

/// What splatting reads and writes, as shadow_maps.h describes the buffers.
struct SplatMemory {
    const uint32_t* casters;  ///< kCasterWords a surfel, by id
    const float* bounds;      ///< kBoundsWords a block
    uint32_t blocks;
    std::span<const VplLight> lights;  ///< one a map
    uint32_t *atlas, *fringe;
    uint32_t* sources = nullptr;  ///< null if they are not requested
    uint32_t* fringe_sources = nullptr;
};
struct SplatLayout {
    uint32_t side;      ///< texels along a side of a map, a multiple of 8
    float splat_angle;  ///< AtlasLayout
    float cut_size;     ///< m, side of the cut's root
    uint32_t id_bits;   ///< of a source's id
};

/// Draws the casters into all maps, as cull.comp, enqueue.comp, splat.comp and splat_large.comp do. A thread
/// draws whole maps, so it needs neither queues nor atomic operations.
void splat(const SplatMemory& memory, const SplatLayout& layout);

}  // namespace lucarne::gi::vpl::native
