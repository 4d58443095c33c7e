#pragma once

#include <cstdint>
#include <optional>

#include "gi/device/gl/device.h"
#include "gi/scene/scene.h"

namespace lucarne::gi {

// The colour maps of what is no picture but a figure.
inline constexpr ColourMap kLuminanceMap = ColourMap::turbo, kDifferenceMap = ColourMap::magma,
                           kSignedMap = ColourMap::cool_warm;

/// cd/m^2 that the ends of false colours stand for: the scene's, or five stops below and above what the
/// exposure makes mid-grey. Photometry is photometry.h's.
ValueRange luminance_range(const std::optional<ValueRange>& wanted, double ev);

/// Luminance on a logarithmic scale. Buffers as tone_map() has them; errors likewise.
Result<void> false_colour(Device& device, const Buffer& radiance, uint32_t pixels, const ValueRange& range,
                          Buffer& picture);

/// `radiance` less `other`, of luminances times 2^ev, or the absolute value of that; `range` has the last
/// colour, and nought the map's middle or its first.
Result<void> difference(Device& device, const Buffer& radiance, const Buffer& other, uint32_t pixels,
                        bool absolute, double ev, double range, Buffer& picture);

/// Puts `other` into the picture right of `border`, a share of the width.
Result<void> split(Device& device, const Buffer& other, uint32_t width, uint32_t height, double border,
                   Buffer& picture);

}  // namespace lucarne::gi
