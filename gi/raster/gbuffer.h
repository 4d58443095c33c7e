#pragma once

#include "gi/device/gl/device.h"
#include "gi/shared/camera.h"
#include "gi/shared/gbuffer.h"
#include "gi/shared/light.h"
#include "gi/shared/material.h"
#include "gi/surfels/surfel_pool.h"

namespace lucarne::gi {

/// What a camera or a light sees of a cut: one GBufferTexel a pixel and the id of the surfel behind it.
struct GBuffer {
    uint32_t width = 0, height = 0;
    Buffer texels;                    ///< GBufferTexel[width * height]
    Buffer ids;                       ///< uint[width * height], kNoSurfel where empty
    Buffer keys, queues, candidates;  ///< scratch of rasterize()
};

/// How large points are drawn; the light sees them as they are.
struct PointSize {
    float scale = 1;   ///< of the discs' radii
    float pixels = 0;  ///< over 0: the diameter of every point, which then faces the eye
};

/// Draws the discs of a cut by compute: per pixel the nearest intersection of its ray with a surfel's disc
/// wins, where overlapping discs of one surface are told apart by whose centre is nearer (kRimPush);
/// equal orders go to the smaller id. A disc takes at least the pixel of its centre. The depths written are
/// the exact plane depths; nothing is smeared in the picture. Errors: out of device memory.
Result<void> rasterize(Device& device, const DeviceCut& cut, const CameraView& view, GBuffer& target,
                       const PointSize& size = {});

/// The square view of a spot (apex at the light, field the full cone) for light G-buffer and shadow map.
CameraView spot_view(const Light& spot, uint32_t resolution);

}  // namespace lucarne::gi
