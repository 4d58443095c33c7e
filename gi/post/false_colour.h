#pragma once

#include <cstdint>
#include <optional>

#include "gi/device/gl/device.h"
#include "gi/raster/gbuffer.h"
#include "gi/scene/scene.h"

namespace lucarne::gi {

// The colour maps of pictures that show figures.
inline constexpr ColourMap kLuminanceMap = ColourMap::turbo, kDifferenceMap = ColourMap::magma,
                           kSignedMap = ColourMap::cool_warm;

/// Returns the luminances, cd/m^2, of the ends of the false colours: `wanted` if given, else five stops
/// below and above the luminance that the exposure makes mid-grey; of illuminances, lx, those that do so to
/// grey surfaces. Photometry is that of photometry.h.
ValueRange false_colour_range(ToneMap shown, const std::optional<ValueRange>& wanted, double ev);

/// Draws luminance on a logarithmic scale. Buffers and errors as for tone_map().
Result<void> false_colour(Device& device, const Buffer& radiance, uint32_t pixels, const ValueRange& range,
                          Buffer& picture);

/// Draws the illuminance of surfaces likewise: of the light that would make them reflect this radiance if
/// they reflected evenly, without what they emit. `materials`: from upload_materials(). Where nothing is
/// shown it is 0.
Result<void> illuminance(Device& device, const Buffer& radiance, const GBuffer& gbuffer,
                         const Buffer& materials, const ValueRange& range, Buffer& picture);

/// Draws the difference `radiance` - `other` of luminances times 2^ev, or its absolute value. `range` is the
/// difference that gets the last colour; 0 gets the middle of the map, or its first colour for absolute
/// values.
Result<void> difference(Device& device, const Buffer& radiance, const Buffer& other, uint32_t pixels,
                        bool absolute, double ev, double range, Buffer& picture);

/// Copies `other` into the picture right of `border`, a share of the width.
Result<void> split(Device& device, const Buffer& other, uint32_t width, uint32_t height, double border,
                   Buffer& picture);

}  // namespace lucarne::gi
