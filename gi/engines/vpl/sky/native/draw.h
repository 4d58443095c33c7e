#pragma once

#include <cstdint>
#include <span>

#include "gi/engines/vpl/shading/sky_map.h"

namespace lucarne::gi::vpl::native {

/// What drawing the maps of the sky reads and writes.
struct SkyDrawing {
    const uint32_t* casters;  ///< kCasterWords a surfel, by id
    const float* bounds;      ///< kBoundsWords a block
    uint32_t blocks;
    float cut_size;  ///< m, side of the cut's root
    std::span<const SkyMap> maps;
    float depth_step;  ///< m
    uint32_t* texels;  ///< of all maps, one after the other; empty ones
};

/// Draws all casters into all maps, as draw.comp does. A thread draws whole maps, so it needs no atomic
/// operations.
void draw_sky_maps(const SkyDrawing& drawing);

}  // namespace lucarne::gi::vpl::native
