#pragma once

#include <cstddef>
#include <span>
#include <vector>

#include "io/core/options.h"

namespace lucarne::viewer {

/// How much a picture differs from the one before: root mean square difference of the shown colours (sRGB, 0
/// to 1). Popping levels of detail show as jumps of this value that motion alone does not cause.
struct PictureChange {
    double whole = 0;  ///< over the picture
    double tile = 0;   ///< over the square of kChangeTile pixels, within the picture, that differs most
};
inline constexpr size_t kChangeTile = 16;

/// Compares two pictures of the same size; RGBA, row 0 on top.
PictureChange change_between(std::span<const std::byte> before, std::span<const std::byte> now,
                             ImageSize size);

}  // namespace lucarne::viewer
