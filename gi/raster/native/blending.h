#pragma once

#include <span>

#include "gi/raster/native/tiles.h"
#include "gi/shared/gbuffer.h"

namespace lucarne::gi::native {

inline constexpr int kBlendingTile = 128;

/// Replaces the texels of a tile by the weighted means of the discs of their surfaces, as blend.comp,
/// blend_large.comp and blend_resolve.comp. `texels` is the whole picture, with the front discs in it.
void draw_blending(const CutMemory& cut, const DiscView& view, const PixelRect& tile,
                   std::span<const PlacedBlock* const> blocks, GBufferTexel* texels);

}  // namespace lucarne::gi::native
