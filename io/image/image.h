#pragma once

#include <cstdint>
#include <filesystem>
#include <string>
#include <vector>

#include <glm/vec4.hpp>

#include "io/core/error.h"

namespace lucarne::io {

/// Linear light, Rec. 709 primaries; rows from the top; w is opacity.
struct Image {
    uint32_t width = 0, height = 0;
    std::vector<glm::vec4> pixels;
    std::string surfaces{};  ///< which surfaces the picture shows, in words; empty: unknown. EXR keeps it
};

/// sRGB, three bytes per pixel; rows from the top.
struct Image8 {
    uint32_t width = 0, height = 0;
    std::vector<uint8_t> bytes;
    std::vector<uint8_t> alpha{};  ///< opacity, one byte per pixel, not premultiplied; empty if opaque
};

/// Readers reject a larger picture before they allocate memory for it.
inline constexpr uint32_t kLargestSide = 16384;
inline constexpr uint64_t kMostPixels = uint64_t{1} << 26;

/// Writes 32-bit float channels R, G, B (and A with `alpha`), ZIP compressed. The file appears whole or not
/// at all. NaN and infinity are written unchanged.
Result<void> write_exr(const std::filesystem::path& path, const Image& image, bool overwrite,
                       bool alpha = false);
/// Reads channels R, G, B or Y, and A if there is one, of any type; scan lines or tiles, the first part.
/// Opacity is 1 if the file has none. Rejects deep pictures, subsampled channels and more than `most_pixels`.
Result<Image> read_exr(const std::filesystem::path& path, uint64_t most_pixels = kMostPixels);

/// Reads a Radiance picture (.hdr): RGBE, flat or run-length coded, rows from the top. Divides by the
/// exposure that its header states.
Result<Image> read_hdr(const std::filesystem::path& path, uint64_t most_pixels = kMostPixels);

/// Writes 8 bits RGB, or RGBA if the picture has opacity, tagged as sRGB. The file appears whole or not at
/// all.
Result<void> write_png(const std::filesystem::path& path, const Image8& image, bool overwrite);
/// Reads any PNG as 8 bits sRGB over black. Its gamma is respected.
Result<Image8> read_png(const std::filesystem::path& path, uint64_t most_pixels = kMostPixels);

/// Reads any grey or colour JPEG (not CMYK); its bytes count as sRGB. A damaged file is read as far as
/// possible.
Result<Image8> read_jpeg(const std::filesystem::path& path, uint64_t most_pixels = kMostPixels);
/// Reads PNG or JPEG; the content tells which.
Result<Image8> read_picture(const std::filesystem::path& path, uint64_t most_pixels = kMostPixels);

}  // namespace lucarne::io
