#pragma once

#include <cstdint>
#include <span>
#include <vector>

#include <glm/vec3.hpp>
#include <glm/vec4.hpp>

#include "gi/device/gl/device.h"
#include "gi/scene/scene.h"

namespace lucarne::gi {

/// How radiance is exposed.
struct Exposure {
    double ev = 0;            ///< stops
    float compression = 0;    ///< of highlights, see gi/shared/tone_curve.h; 0: none
    glm::vec3 balance{1.0f};  ///< factors of red, green, blue: white balance, see white_balance()
};

/// Returns the factors that make radiance of the colour `white` neutral and keep its luminance (von Kries'
/// rule, in linear Rec. 709).
glm::vec3 white_balance(const glm::dvec3& white);

/// Maps linear radiance times 2^ev through the curve to RGBA8 (sRGB-coded), one 32-bit word a pixel, red in
/// the lowest byte. NaN becomes black. Errors: the shader's, no device memory.
Result<void> tone_map(Device& device, const Buffer& radiance, uint32_t pixels, ToneMap curve,
                      const Exposure& exposure, Buffer& picture);

/// The same on the host, for pictures from files. Returns linear light in [0, 1], not sRGB-coded.
std::vector<glm::vec4> tone_map(std::span<const glm::vec4> radiance, ToneMap curve, const Exposure& exposure);

}  // namespace lucarne::gi
