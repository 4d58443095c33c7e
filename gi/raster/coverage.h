#pragma once

#include "gi/raster/gbuffer.h"

namespace lucarne::gi {

/// Finds how much of each pixel at an edge shows the surfaces of its neighbours, into `target.coverage`
/// (coverage_code.h): the discs that won the pixel and its eight neighbours are met by eight rays through the
/// pixel. So a single picture has the soft outlines of an average of pictures whose rays pass through other
/// places of their pixels. Call it after rasterize() or blend() with the same cut, view and size. Errors: out
/// of device memory; the shader's.
Result<void> find_coverage(Device& device, const DeviceCut& cut, const CameraView& view, GBuffer& target,
                           const PointSize& size = {});

}  // namespace lucarne::gi
