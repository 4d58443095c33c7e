// JPEG through libjpeg-turbo's own interface, which reports errors without longjmp.
#include <array>
#include <cstddef>
#include <memory>
#include <span>
#include <string_view>

#include <fmt/format.h>
#include <turbojpeg.h>

#include "io/files/file.h"
#include "io/image/image.h"

namespace lucarne::io {
namespace {

constexpr uint64_t kLargestJpeg = uint64_t{1} << 30;
/// A block of 8x8 pixels takes at least one bit of Huffman code: 512 pixels a byte. Arithmetic codes, which
/// are very rare, may take less.
constexpr uint64_t kMostPixelsPerJpegByte = 1024;

struct Destroy {
    void operator()(void* handle) const { tjDestroy(handle); }
};

}  // namespace

Result<Image8> read_jpeg(const std::filesystem::path& path, uint64_t most_pixels) {
    const std::string name = path.string();
    LUCARNE_ASSIGN(const auto file, InputFile::open(path));
    if (file.size() > kLargestJpeg) return rejected(name, "is too large for a JPEG picture");
    std::vector<unsigned char> encoded(static_cast<size_t>(file.size()));
    LUCARNE_TRY(file.read_at(0, std::as_writable_bytes(std::span(encoded))));
    const std::unique_ptr<void, Destroy> decoder(tjInitDecompress());
    if (!decoder) return failed(name, "the JPEG decoder does not start");
    int width = 0, height = 0, sampling = 0, colors = 0;
    if (tjDecompressHeader3(decoder.get(), encoded.data(), encoded.size(), &width, &height, &sampling,
                            &colors) != 0)
        return rejected(name, fmt::format("is no usable JPEG picture ({})", tjGetErrorStr2(decoder.get())));
    const auto w = static_cast<uint32_t>(width), h = static_cast<uint32_t>(height);
    if (width < 1 || height < 1 || w > kLargestSide || h > kLargestSide || uint64_t{w} * h > most_pixels)
        return rejected(name, fmt::format("is too large: {}x{} pixels", width, height));
    if (uint64_t{w} * h / kMostPixelsPerJpegByte > file.size())
        return rejected(name, fmt::format("is shorter than its {}x{} pixels", width, height));
    Image8 image{w, h, std::vector<uint8_t>(size_t{3} * w * h)};
    // Many scans of a progressive picture would take hours to decode; libjpeg-turbo allows 500.
    if (tjDecompress2(decoder.get(), encoded.data(), encoded.size(), image.bytes.data(), width, 0, height,
                      TJPF_RGB, TJFLAG_ACCURATEDCT | TJFLAG_LIMITSCANS) != 0 &&
        tjGetErrorCode(decoder.get()) == TJERR_FATAL)
        return rejected(name, fmt::format("is no usable JPEG picture ({})", tjGetErrorStr2(decoder.get())));
    return image;
}

Result<Image8> read_picture(const std::filesystem::path& path, uint64_t most_pixels) {
    LUCARNE_ASSIGN(const auto file, InputFile::open(path));
    std::array<std::byte, 4> head{};
    LUCARNE_ASSIGN(const size_t got, file.read_some(0, head));
    const std::string_view text(reinterpret_cast<const char*>(head.data()), got);
    if (text.starts_with("\x89PNG")) return read_png(path, most_pixels);
    if (text.starts_with("\xff\xd8\xff")) return read_jpeg(path, most_pixels);
    return rejected(path.string(), "is neither PNG nor JPEG");
}

}  // namespace lucarne::io
