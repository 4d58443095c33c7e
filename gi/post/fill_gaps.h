#pragma once

#include "gi/device/gl/device.h"
#include "gi/raster/gbuffer.h"

namespace lucarne::gi {

constexpr uint32_t kMostReach = 64;  ///< pixels

/// Fills pixels of a finished picture that show no point, but have points within `reach` pixels on both sides
/// along two of four axes: with the mean of the nearest of these, by the inverse square of their distance.
/// For pictures of a few points of a scan, drawn small. `averaged` as for draw_backdrop(). Openings wider
/// than twice the reach stay. `reach`: kMostReach at most; more counts as that. Errors: the shader's.
Result<void> fill_gaps(Device& device, const GBuffer& gbuffer, const Buffer& radiance, bool averaged,
                       uint32_t reach, Buffer& picture);

}  // namespace lucarne::gi
