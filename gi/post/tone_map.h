#pragma once

#include <cstdint>
#include <span>
#include <vector>

#include <glm/vec4.hpp>

#include "gi/device/gl/device.h"
#include "gi/scene/scene.h"

namespace lucarne::gi {

/// How radiance is exposed.
struct Exposure {
    double ev = 0;          ///< stops
    float compression = 0;  ///< of highlights, see gi/shared/tone_curve.h; 0: none
};

/// Maps linear radiance times 2^ev through the curve to RGBA8 (sRGB-coded), one 32-bit word a pixel, red in
/// the lowest byte. NaN becomes black. Errors: the shader's, no device memory.
Result<void> tone_map(Device& device, const Buffer& radiance, uint32_t pixels, ToneMap curve,
                      const Exposure& exposure, Buffer& picture);

/// The same on the host, for pictures from files. Returns linear light in [0, 1], not sRGB-coded.
std::vector<glm::vec4> tone_map(std::span<const glm::vec4> radiance, ToneMap curve, const Exposure& exposure);

}  // namespace lucarne::gi
