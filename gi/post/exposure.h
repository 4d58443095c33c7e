#pragma once

#include <span>

#include <glm/vec4.hpp>

#include "gi/device/gl/device.h"
#include "gi/post/tone_map.h"
#include "gi/raster/gbuffer.h"

namespace lucarne::gi {

/// Returns the exposure, in stops, that brings the log-average luminance of the lit pixels to the key .18
/// (Reinhard et al. 2002, eqs 1 and 2); 0 for a black picture.
double log_average_exposure(std::span<const glm::vec4> radiance);

/// The same on the device, for pictures in which at most kClippedShare of the pixels that show points come
/// out nearly white: the exposure is lowered by up to kMostLowered stops, and what is brighter still is
/// compressed, by up to kMostCompressed stops, so that shadows stay visible. Sky does not count as points.
/// `radiance` is a vec4 a pixel of the G-buffer; `balance` becomes the exposure's. Errors: the shader's, no
/// device memory.
Result<Exposure> automatic_exposure(Device& device, const Buffer& radiance, const GBuffer& gbuffer,
                                    ToneMap curve, const glm::vec3& balance = glm::vec3(1.0f));

/// Returns the exposure `share` of the way from `a` to `b`; 1 is `b`.
Exposure between(const Exposure& a, const Exposure& b, double share);

inline constexpr double kClippedShare = .02;
inline constexpr double kMostLowered = .75, kMostCompressed = 5;  ///< stops
inline constexpr double kNearlyWhite = 244.0 / 255;               ///< sRGB-coded

}  // namespace lucarne::gi
