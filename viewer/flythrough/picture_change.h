#pragma once

#include <cstddef>
#include <span>
#include <vector>

#include "io/core/options.h"

namespace lucarne::viewer {

/// How much a picture differs from the one before: of the shown colours (sRGB, 0 to 1), root mean square. A
/// level of detail that pops is seen as a jump of it that the motion alone does not make.
struct PictureChange {
    double whole = 0;  ///< over the picture
    double tile = 0;   ///< over the square of kChangeTile pixels, within the picture, that differs most
};
inline constexpr size_t kChangeTile = 16;

/// Both RGBA, row 0 on top, `size` large.
PictureChange change_between(std::span<const std::byte> before, std::span<const std::byte> now,
                             ImageSize size);

}  // namespace lucarne::viewer
