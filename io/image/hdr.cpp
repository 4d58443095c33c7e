// Radiance pictures (.hdr): 8-bit mantissas with a shared exponent, flat or run-length coded by scan line.
// Format: Ward, "Real Pixels", Graphics Gems II, 1991; Radiance reference manual, "Picture file format".
#include <algorithm>
#include <array>
#include <charconv>
#include <cmath>
#include <optional>
#include <string>
#include <string_view>

#include <fmt/format.h>

#include "io/files/file.h"
#include "io/image/image.h"

namespace lucarne::io {
namespace {

constexpr size_t kLongestHeader = 65536;
constexpr size_t kLongestRun = 127;

/// Reads a file from front to back in pieces.
class Stream {
 public:
    Stream(const ByteSource& file, uint64_t at) : file_(file), at_(at) {}

    uint64_t left() const { return file_.size() - at_ + (end_ - next_); }
    Result<uint8_t> byte() {
        if (next_ == end_) {
            LUCARNE_ASSIGN(const size_t got, file_.read_some(at_, piece_));
            if (got == 0) return rejected(file_.path().string(), "ends early");
            at_ += got;
            next_ = 0;
            end_ = got;
        }
        return static_cast<uint8_t>(piece_[next_++]);
    }

 private:
    const ByteSource& file_;
    uint64_t at_;
    std::array<std::byte, 65536> piece_;
    size_t next_ = 0, end_ = 0;
};

struct Header {
    uint32_t width = 0, height = 0;
    float scale = 1;  ///< values are divided by it
    uint64_t bytes = 0;
};

std::optional<uint32_t> side(std::string_view text) {
    uint32_t value = 0;
    const auto [end, error] = std::from_chars(text.data(), text.data() + text.size(), value);
    if (error != std::errc() || end != text.data() + text.size() || value < 1 || value > kLargestSide)
        return std::nullopt;
    return value;
}

/// Parses "-Y 512 +X 1024": rows from the top, pixels from the left. The other orders are rare.
bool read_size(std::string_view line, Header& header) {
    if (!line.starts_with("-Y ")) return false;
    line.remove_prefix(3);
    const size_t middle = line.find(" +X ");
    if (middle == std::string_view::npos) return false;
    const auto height = side(line.substr(0, middle)), width = side(line.substr(middle + 4));
    if (!height || !width) return false;
    header.width = *width;
    header.height = *height;
    return true;
}

Result<Header> read_header(const ByteSource& file) {
    const std::string name = file.path().string();
    std::string text(std::min<uint64_t>(file.size(), kLongestHeader), '\0');
    LUCARNE_TRY(file.read_at(0, std::as_writable_bytes(std::span(text))));
    if (!text.starts_with("#?")) return rejected(name, "is no Radiance picture");
    Header header;
    size_t at = 0;
    for (bool blank = false;;) {
        const size_t end = text.find('\n', at);
        if (end == std::string::npos) return rejected(name, "its header has no end");
        const std::string_view line = std::string_view(text).substr(at, end - at);
        at = end + 1;
        if (blank) {
            if (!read_size(line, header))
                return rejected(name, "its size cannot be read (-Y height +X width, up to 16384)");
            break;
        }
        blank = line.empty();
        if (line.starts_with("FORMAT=") && line != "FORMAT=32-bit_rle_rgbe")
            return rejected(name, "its colours are not RGBE");
        if (line.starts_with("EXPOSURE="))
            header.scale *= std::strtof(std::string(line.substr(9)).c_str(), nullptr);
    }
    if (!(header.scale > 0) || !std::isfinite(header.scale))
        return rejected(name, "its exposure is no number");
    header.bytes = at;
    return header;
}

/// Reads one scan line of four planes. Each consists of runs (a count over 128 and one value) and copies (a
/// count and values).
Result<void> read_runs(Stream& stream, const std::string& name, std::vector<uint8_t>& planes,
                       uint32_t width) {
    for (size_t at = 0; at < planes.size();) {
        const size_t end = (at / width + 1) * width;
        LUCARNE_ASSIGN(const uint8_t code, stream.byte());
        const size_t count = code > 128 ? code - 128u : code;
        if (count == 0 || count > end - at) return rejected(name, "a run does not fit its scan line");
        LUCARNE_ASSIGN(uint8_t value, stream.byte());
        for (size_t i = 0; i < count; ++i) {
            planes[at++] = value;
            if (code <= 128 && i + 1 < count) {
                LUCARNE_ASSIGN(value, stream.byte());
            }
        }
    }
    return {};
}

/// Reads a scan line, by plane: red, green, blue, exponent.
Result<void> read_line(Stream& stream, const std::string& name, std::vector<uint8_t>& planes,
                       uint32_t width) {
    uint8_t first[4];
    for (uint8_t& byte : first) {
        LUCARNE_ASSIGN(byte, stream.byte());
    }
    const bool in_runs = width >= 8 && first[0] == 2 && first[1] == 2 && first[2] < 128;
    if (in_runs) {
        if (first[2] * 256u + first[3] != width) return rejected(name, "a scan line has another width");
        return read_runs(stream, name, planes, width);
    }
    for (uint32_t x = 0; x < width; ++x) {
        for (uint32_t plane = 0; plane < 4; ++plane) {
            if (x > 0) {
                LUCARNE_ASSIGN(first[plane], stream.byte());
            }
            planes[size_t{plane} * width + x] = first[plane];
        }
        if (first[0] == 1 && first[1] == 1 && first[2] == 1)
            return rejected(name, "uses the run-length coding of before 1991");
    }
    return {};
}

}  // namespace

Result<Image> read_hdr(const std::filesystem::path& path, uint64_t most_pixels) {
    LUCARNE_ASSIGN(const auto file, InputFile::open(path));
    const std::string name = path.string();
    LUCARNE_ASSIGN(const Header header, read_header(file));
    const uint64_t pixels = uint64_t{header.width} * header.height;
    if (const uint64_t most = std::min(most_pixels, kMostPixels); pixels > most)
        return rejected(name, fmt::format("it has {}x{} pixels, which is too large: at most {} in all",
                                          header.width, header.height, most));
    Stream stream(file, header.bytes);
    // The shortest scan line consists of runs only: two bytes for 127 values.
    const uint64_t shortest =
        std::min<uint64_t>(4ull * header.width, 4 + 8 * ((header.width + kLongestRun - 1) / kLongestRun));
    if (stream.left() < shortest * header.height) return rejected(name, "is shorter than its picture");
    Image image{header.width, header.height, {}};
    image.pixels.reserve(pixels);
    std::vector<uint8_t> planes(size_t{4} * header.width);
    for (uint32_t y = 0; y < header.height; ++y) {
        LUCARNE_TRY(read_line(stream, name, planes, header.width));
        for (size_t x = 0; x < header.width; ++x) {
            const uint8_t exponent = planes[3 * size_t{header.width} + x];
            const float unit = exponent ? std::ldexp(1.0f, exponent - 136) / header.scale : 0.0f;
            image.pixels.emplace_back(static_cast<float>(planes[x]) * unit,
                                      static_cast<float>(planes[header.width + x]) * unit,
                                      static_cast<float>(planes[2 * size_t{header.width} + x]) * unit, 1.0f);
        }
    }
    return image;
}

}  // namespace lucarne::io
