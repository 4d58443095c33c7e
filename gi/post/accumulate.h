#pragma once

#include <cstdint>

#include "gi/device/gl/device.h"
#include "gi/raster/gbuffer.h"

namespace lucarne::gi {

/// Updates `mean` to the average of the `count` samples given so far, of which `sample` is the last and
/// `gbuffer` its surfaces. Both hold a vec4 a pixel; w of the mean becomes the share of the samples that show
/// a point. `points_only` averages these samples alone, so that no background is mixed in. The content of
/// `mean` before the first sample does not matter. Errors: the shader's.
Result<void> accumulate(Device& device, const Buffer& sample, const GBuffer& gbuffer, uint32_t count,
                        bool points_only, Buffer& mean);

}  // namespace lucarne::gi
