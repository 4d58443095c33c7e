#pragma once

#include "gi/raster/gbuffer.h"

namespace lucarne::gi {

/// Replaces depth, normal and colour of each texel by the weighted mean of all discs within a slab about the
/// front surface. The ids stay those of the front discs. Call it after rasterize() with the same cut, view
/// and size. Discs of other materials, beyond a crease or on the far side of a thin wall do not contribute.
/// The result is the same on every run. Points of a fixed size in pixels are left as they are. Errors: out of
/// device memory.
Result<void> blend(Device& device, const DeviceCut& cut, const CameraView& view, GBuffer& target,
                   const PointSize& size = {});

}  // namespace lucarne::gi
