#pragma once

#include <cstdint>
#include <span>

#include "gi/raster/native/tiles.h"
#include "gi/shared/gbuffer.h"

namespace lucarne::gi::native {

inline constexpr int kVisibilityTile = 128;

/// The pictures that a tile is drawn into, whole.
struct VisibilityTarget {
    GBufferTexel* texels;
    uint32_t* ids;
    uint8_t* blended;  ///< by block: set to 1 if blending has to draw it
};

/// Draws a tile: the ids and the texels of the nearest discs, as splat.comp, splat_large.comp and
/// resolve.comp.
void draw_visibility(const CutMemory& cut, const DiscView& view, const PixelRect& tile,
                     std::span<const PlacedBlock* const> blocks, const VisibilityTarget& target);

}  // namespace lucarne::gi::native
