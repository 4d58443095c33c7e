#pragma once

#include <cstdint>
#include <filesystem>
#include <vector>

#include <glm/vec4.hpp>

#include "io/core/error.h"

namespace lucarne::io {

/// Linear light, Rec. 709 primaries; rows from the top, w is opacity.
struct Image {
    uint32_t width = 0, height = 0;
    std::vector<glm::vec4> pixels;
};

/// sRGB, three bytes a pixel; rows from the top.
struct Image8 {
    uint32_t width = 0, height = 0;
    std::vector<uint8_t> bytes;
    std::vector<uint8_t> alpha{};  ///< opacity, one byte a pixel, not multiplied in; empty: opaque
};

/// Readers reject a picture beyond these before they allocate anything for it.
inline constexpr uint32_t kLargestSide = 16384;
inline constexpr uint64_t kMostPixels = uint64_t{1} << 26;

/// 32-bit float channels R, G, B (and A with `alpha`), ZIP compressed. The file appears whole or not at all.
/// A NaN or an infinity is written as it is.
Result<void> write_exr(const std::filesystem::path& path, const Image& image, bool overwrite,
                       bool alpha = false);
/// Channels R, G, B or Y, and A where there is one, of any type; scan lines or tiles, the first part. Opacity
/// is 1 where the file has none. Deep pictures, subsampled channels and more than `most_pixels` are rejected.
Result<Image> read_exr(const std::filesystem::path& path, uint64_t most_pixels = kMostPixels);

/// A Radiance picture (.hdr): RGBE, flat or run-length coded, rows from the top; what its header says of the
/// exposure is taken out.
Result<Image> read_hdr(const std::filesystem::path& path, uint64_t most_pixels = kMostPixels);

/// 8 bits RGB, or RGBA where there is opacity, tagged sRGB. The file appears whole or not at all.
Result<void> write_png(const std::filesystem::path& path, const Image8& image, bool overwrite);
/// Any PNG, brought to 8 bits sRGB (its gamma is respected) over black.
Result<Image8> read_png(const std::filesystem::path& path, uint64_t most_pixels = kMostPixels);

/// Any JPEG of grey or colour (not CMYK), its bytes taken as sRGB. A damaged one is read as far as it goes.
Result<Image8> read_jpeg(const std::filesystem::path& path, uint64_t most_pixels = kMostPixels);
/// PNG or JPEG, told apart by content.
Result<Image8> read_picture(const std::filesystem::path& path, uint64_t most_pixels = kMostPixels);

}  // namespace lucarne::io
