#pragma once

#include <span>
#include <vector>

#include "gi/raster/native/tiles.h"

namespace lucarne::gi::native {

/// Whether a cut on a device is drawn in C++.
bool draws(const Device& device, const DeviceCut& cut);

/// Draws a cut as gi::rasterize() does, into GBufferTexel[] and uint[]. Sets `to_blend` to the blocks that
/// blend() has to draw.
Result<void> rasterize(const DeviceCut& cut, const DiscView& view, const Buffer& texels, const Buffer& ids,
                       std::vector<PlacedBlock>& to_blend);

/// Blends the texels of a picture as gi::blend() does.
Result<void> blend(const DeviceCut& cut, const DiscView& view, const Buffer& texels,
                   std::span<const PlacedBlock> to_blend);

/// Finds the coverage of a picture's pixels as gi::find_coverage() does.
Result<void> find_coverage(const DeviceCut& cut, const CameraView& camera, const DiscView& view,
                           const Buffer& texels, const Buffer& ids, const Buffer& coverage);

/// Runs the kernels with the instructions that are at hand, from the slowest set to the fastest: `set` counts
/// them. Returns false if there is no such set. For tests; `set` below 0 returns to the fastest.
bool use_instruction_set(int set);

}  // namespace lucarne::gi::native
