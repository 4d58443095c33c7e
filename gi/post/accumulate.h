#pragma once

#include <cstdint>

#include "gi/device/gl/device.h"

namespace lucarne::gi {

/// Updates `mean` to the average of the `count` samples given so far: mean += (sample - mean) / count. Both
/// hold a vec4 a pixel. The content of `mean` before the first sample does not matter. Errors: the shader's.
Result<void> accumulate(Device& device, const Buffer& sample, uint32_t pixels, uint32_t count, Buffer& mean);

}  // namespace lucarne::gi
