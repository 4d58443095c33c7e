// Makes EXR and PNG with Lucarne's own writers; Radiance (flat and in runs) and JPEG by hand.
#include <stdexcept>

#include <glm/vec4.hpp>

#include "io/image/image.h"
#include "tests/fuzz/seeds/seeds.h"

namespace lucarne::fuzz {
namespace {

io::Image picture() {
    io::Image image{12, 6, {}};
    for (size_t i = 0; i < 72; ++i)
        image.pixels.emplace_back(0.5f * static_cast<float>(i % 5), 1.0f, 0.0f, 0.25f);
    return image;
}

void require(const Result<void>& done) {
    if (!done) throw std::runtime_error(done.error().line());
}

std::string runs_of(char value, int width) {
    return {static_cast<char>(128 + width), value};
}

/// Returns a JPEG marker with its segment.
std::string segment(char marker, const std::string& content) {
    const size_t length = content.size() + 2;
    return std::string("\xff", 1) + marker + static_cast<char>(length >> 8) + static_cast<char>(length) +
           content;
}

/// Returns 16x8 grey pixels. Each block takes one code: its mean does not change, and it has nothing else.
std::string grey_jpeg() {
    const std::string one_code = '\1' + std::string(15, '\0') + '\0';
    return "\xff\xd8" + segment('\xdb', '\0' + std::string(64, '\1')) +
           segment('\xc0', std::string("\x08\0\x08\0\x10\1\1\x11\0", 9)) + segment('\xc4', '\0' + one_code) +
           segment('\xc4', '\x10' + one_code) + segment('\xda', std::string("\1\1\0\0\x3f\0", 6)) +
           "\x0f\xff\xd9";
}

}  // namespace

void picture_seeds(const Seeds& exr, const Seeds& hdr, const Seeds& png, const Seeds& jpeg) {
    for (const bool alpha : {false, true})
        require(io::write_exr(exr.folder() / (alpha ? "alpha" : "opaque"), picture(), true, alpha));
    io::Image8 bytes{9, 5, {}};
    for (size_t i = 0; i < 3 * 45; ++i) bytes.bytes.push_back(static_cast<uint8_t>(i * i));
    require(io::write_png(png.folder() / "rgb", bytes, true));

    std::string flat = "#?RADIANCE\nFORMAT=32-bit_rle_rgbe\nEXPOSURE=2\n\n-Y 2 +X 3\n";
    for (int i = 0; i < 6; ++i) flat += "\x40\x80\x20\x81";
    hdr.add("flat", flat);
    std::string runs = "#?RADIANCE\nFORMAT=32-bit_rle_rgbe\n\n-Y 2 +X 10\n";
    for (int line = 0; line < 2; ++line)
        runs += std::string("\2\2\0\x0a", 4) + runs_of('\x40', 10) + "\x0a" + "abcdefghij" +
                runs_of('\x20', 10) + runs_of('\x81', 10);
    hdr.add("runs", runs);
    jpeg.add("grey", grey_jpeg());
    if (const auto read = io::read_jpeg(jpeg.folder() / "grey"); !read)
        throw std::runtime_error(read.error().line());
}

}  // namespace lucarne::fuzz
