// PNG through libpng's simplified interface, which reports errors without longjmp.
#include <cstddef>
#include <memory>
#include <span>

#include <fmt/format.h>
#include <png.h>

#include "io/files/file.h"
#include "io/image/image.h"

namespace lucarne::io {
namespace {

constexpr uint64_t kLargestPng = uint64_t{1} << 30;
/// A byte of a deflate stream expands to at most 1032 bytes (zlib, "Technical details"), each of up to eight
/// 1-bit pixels.
constexpr uint64_t kMostPixelsPerPngByte = 8 * 1032;

struct PngFree {
    void operator()(png_image* image) const { png_image_free(image); }
};

std::vector<uint8_t> interleaved(const Image8& image) {
    std::vector<uint8_t> rgba;
    rgba.reserve(image.alpha.size() * 4);
    for (size_t i = 0; i < image.alpha.size(); ++i) {
        for (size_t channel = 0; channel < 3; ++channel) rgba.push_back(image.bytes[3 * i + channel]);
        rgba.push_back(image.alpha[i]);
    }
    return rgba;
}

}  // namespace

Result<void> write_png(const std::filesystem::path& path, const Image8& image, bool overwrite) {
    const std::string name = path.string();
    const size_t count = size_t{image.width} * image.height;
    if (count == 0 || image.bytes.size() != 3 * count ||
        (!image.alpha.empty() && image.alpha.size() != count))
        return failed(name, fmt::format("no picture of {}x{} can be written", image.width, image.height));
    png_image png{};
    png.version = PNG_IMAGE_VERSION;
    png.width = image.width;
    png.height = image.height;
    std::vector<uint8_t> with_alpha;
    if (!image.alpha.empty()) with_alpha = interleaved(image);
    const void* pixels = with_alpha.empty() ? image.bytes.data() : with_alpha.data();
    png.format = with_alpha.empty() ? PNG_FORMAT_RGB : PNG_FORMAT_RGBA;
    png_alloc_size_t bytes = PNG_IMAGE_PNG_SIZE_MAX(png);
    std::vector<std::byte> encoded(bytes);
    if (!png_image_write_to_memory(&png, encoded.data(), &bytes, 0, pixels, 0, nullptr))
        return failed(name, fmt::format("cannot be encoded as PNG ({})", png.message));
    return write_file(path, std::span<const std::byte>(encoded).first(bytes), overwrite);
}

Result<Image8> read_png(const std::filesystem::path& path, uint64_t most_pixels) {
    const std::string name = path.string();
    LUCARNE_ASSIGN(const auto file, InputFile::open(path));
    if (file.size() > kLargestPng) return rejected(name, "is too large for a PNG picture");
    std::vector<std::byte> encoded(static_cast<size_t>(file.size()));
    LUCARNE_TRY(file.read_at(0, encoded));
    png_image png{};
    png.version = PNG_IMAGE_VERSION;
    const std::unique_ptr<png_image, PngFree> owner(&png);
    if (!png_image_begin_read_from_memory(&png, encoded.data(), encoded.size()))
        return rejected(name, fmt::format("is no usable PNG picture ({})", png.message));
    if (png.width > kLargestSide || png.height > kLargestSide ||
        uint64_t{png.width} * png.height > most_pixels)
        return rejected(name, fmt::format("is too large: {}x{} pixels", png.width, png.height));
    if (uint64_t{png.width} * png.height / kMostPixelsPerPngByte > file.size())
        return rejected(name, fmt::format("is shorter than its {}x{} pixels", png.width, png.height));
    png.format = PNG_FORMAT_RGB;
    Image8 image{png.width, png.height, std::vector<uint8_t>(size_t{3} * png.width * png.height)};
    const png_color black{};
    if (!png_image_finish_read(&png, &black, image.bytes.data(), 0, nullptr))
        return rejected(name, fmt::format("is no usable PNG picture ({})", png.message));
    return image;
}

}  // namespace lucarne::io
