#pragma once

#include <cstddef>
#include <span>

#include "io/core/options.h"
#include "io/image/image.h"

namespace lucarne::viewer {

/// Converts RGBA8 rows, as the pipeline and the window hold them, to RGB for writing.
inline io::Image8 without_alpha(std::span<const std::byte> rgba, ImageSize size) {
    io::Image8 image{size.width, size.height, {}};
    image.bytes.reserve(rgba.size() / 4 * 3);
    for (size_t i = 0; i + 3 < rgba.size(); i += 4)
        for (size_t channel = 0; channel < 3; ++channel)
            image.bytes.push_back(static_cast<uint8_t>(rgba[i + channel]));
    return image;
}

}  // namespace lucarne::viewer
