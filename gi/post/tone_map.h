#pragma once

#include <cstdint>
#include <span>
#include <vector>

#include <glm/vec4.hpp>

#include "gi/device/gl/device.h"
#include "gi/scene/scene.h"

namespace lucarne::gi {

/// Returns the exposure, in stops, that brings the log-average luminance of the lit pixels to the key .18
/// (Reinhard et al. 2002, eqs 1 and 2); 0 for a black picture. `radiance` is a vec4 a pixel. Errors: the
/// shader's, no device memory.
Result<double> automatic_exposure(Device& device, const Buffer& radiance, uint32_t pixels);

/// Maps linear radiance times 2^ev through the curve to RGBA8 (sRGB-coded), one 32-bit word a pixel, red in
/// the lowest byte. NaN becomes black. Errors: the shader's, no device memory.
Result<void> tone_map(Device& device, const Buffer& radiance, uint32_t pixels, ToneMap curve, double ev,
                      Buffer& picture);

// The same on the host, for pictures from files.
double automatic_exposure(std::span<const glm::vec4> radiance);
/// Returns linear light in [0, 1], not sRGB-coded.
std::vector<glm::vec4> tone_map(std::span<const glm::vec4> radiance, ToneMap curve, double ev);

}  // namespace lucarne::gi
