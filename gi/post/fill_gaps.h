#pragma once

#include "gi/device/gl/device.h"
#include "gi/raster/gbuffer.h"

namespace lucarne::gi {

/// Fills pixels of a finished picture that show no point, but have points within `reach` pixels on both sides
/// along two of four axes: with the mean of the nearest of these, by the inverse square of their distance.
/// For pictures of a few points of a scan, drawn small. `averaged` as for draw_backdrop(). Openings wider
/// than twice the reach stay. Errors: the shader's.
Result<void> fill_gaps(Device& device, const GBuffer& gbuffer, const Buffer& radiance, bool averaged,
                       uint32_t reach, Buffer& picture);

}  // namespace lucarne::gi
