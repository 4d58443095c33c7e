#pragma once

#include "gi/device/gl/device.h"
#include "gi/raster/disc_view.h"
#include "gi/raster/native/tiles.h"
#include "gi/shared/camera.h"
#include "gi/shared/gbuffer.h"
#include "gi/shared/light.h"
#include "gi/shared/material.h"
#include "gi/surfels/surfel_pool.h"

namespace lucarne::gi {

/// What a camera or a light sees of a cut: one GBufferTexel per pixel and the id of the surfel behind it.
struct GBuffer {
    uint32_t width = 0, height = 0;
    Buffer texels;                                 ///< GBufferTexel[width * height]
    Buffer ids;                                    ///< uint[width * height], kNoSurfel where empty
    Buffer keys, queues, candidates, seen_blocks;  ///< scratch of rasterize()
    Buffer sums;                                   ///< scratch of blend(), zero between its calls
    Buffer coverage;  ///< of find_coverage(): uint[width * height]; before it scratch of turn_rims(), four
                      ///< times as large
    std::vector<native::PlacedBlock> to_blend;  ///< of native passes
};

/// Draws the discs of a cut, by compute shaders or natively (Device::native_passes()). In each pixel the
/// nearest intersection of its ray with a disc wins. Where discs of one surface overlap, the nearest centre
/// wins (kRimPush); ties go to the smaller id. A disc competes at least for the pixel of its centre. The
/// depths written are the exact depths of planes; nothing is blurred in the picture. Errors: out of device
/// memory.
Result<void> rasterize(Device& device, const DeviceCut& cut, const CameraView& view, GBuffer& target,
                       const PointSize& size = {});

/// Returns the square view of a spot (apex at the light, field of view the full cone) for its G-buffer,
/// which is also its shadow map.
CameraView spot_view(const Light& spot, uint32_t resolution);

}  // namespace lucarne::gi
