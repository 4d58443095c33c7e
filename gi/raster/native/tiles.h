#pragma once

#include <cstdint>
#include <functional>
#include <span>
#include <vector>

#include "gi/raster/disc_view.h"
#include "gi/surfels/surfel_pool.h"

namespace lucarne::gi::native {

/// Pixels x0 <= x < x1, y0 <= y < y1.
struct PixelRect {
    int x0, y0, x1, y1;
    bool overlaps(const PixelRect& other) const {
        return x0 < other.x1 && other.x0 < x1 && y0 < other.y1 && other.y0 < y1;
    }
};

/// A block of a cut in a picture.
struct PlacedBlock {
    PixelRect rect;  ///< has all pixels that its discs may take
    float nearest;   ///< no order of its discs (disc_key) is smaller, m
    uint32_t block;
};

/// Returns the blocks that may be seen, front to back.
std::vector<PlacedBlock> place_blocks(const HostSurfels& surfels, const DiscView& view);

/// Calls draw(tile, blocks) for every square tile of `size` pixels in parallel, with the blocks that overlap
/// it, front to back. Tiles without blocks are drawn as well. Memory does not grow with the picture: large
/// ones are drawn in parts.
void for_tiles(std::span<const PlacedBlock> blocks, const DiscView& view, int size,
               const std::function<void(const PixelRect&, std::span<const PlacedBlock* const>)>& draw);

/// What the kernels read of a cut.
struct CutMemory {
    const PackedSurfel* pool;
    const CutItem* items;
    const CutBlock* blocks;
    const float* radii;            ///< HostSurfels::radii
    const uint32_t* first_radius;  ///< HostSurfels::first
};

}  // namespace lucarne::gi::native
