#include "io/image/exr_header.h"

#include <algorithm>
#include <array>
#include <cstring>
#include <string_view>
#include <vector>

#include <fmt/format.h>

#include "io/image/image.h"

namespace lucarne::io {
namespace {

constexpr uint64_t kMostHeaderBytes = uint64_t{16} << 20;
constexpr uint64_t kMostChunkBytes = uint64_t{64} << 20;
constexpr size_t kMostParts = 1000;
constexpr uint32_t kDeep = 0x800, kMultiPart = 0x1000;  ///< flags of the version
/// Scan lines in a chunk, indexed by the compression: none, RLE, ZIPS, ZIP, PIZ, PXR24, B44, B44A, DWAA,
/// DWAB.
constexpr std::array<uint64_t, 10> kChunkLines = {1, 1, 1, 16, 32, 16, 32, 32, 32, 256};

/// The unread part of the header, consumed from its front. Missing values are empty or 0, and set `short_`.
class Bytes {
 public:
    explicit Bytes(std::string_view bytes) : rest_(bytes) {}

    std::string_view take(uint64_t count) {
        if (count > rest_.size()) {
            short_ = true;
            rest_ = {};
            return {};
        }
        const auto taken = rest_.substr(0, count);
        rest_.remove_prefix(count);
        return taken;
    }
    template <class T>
    T number() {
        T value{};
        const auto taken = take(sizeof value);
        if (!taken.empty()) std::memcpy(&value, taken.data(), sizeof value);
        return value;
    }
    /// Reads up to the next zero byte.
    std::string_view name() {
        const auto name = take(std::min(rest_.find('\0'), rest_.size()));
        take(1);
        return name;
    }
    bool cut_off() const { return short_; }
    bool at_end() const { return rest_.empty(); }

 private:
    std::string_view rest_;
    bool short_ = false;
};

struct Part {
    uint64_t width = 0, height = 0, pixel_bytes = 0, chunk_lines = 1, said_chunks = 0;
    uint64_t tile_width = 0, tile_height = 0;  ///< 0 means none
};

/// Types that the library reads with their own size, whatever size the attribute states. If the two differ,
/// the library continues at another place than this check, and sees another header there.
struct FixedType {
    std::string_view name;
    size_t bytes;
};
constexpr std::array kFixedTypes = {FixedType{"box2f", 16},
                                    FixedType{"box2i", 16},
                                    FixedType{"chromaticities", 32},
                                    FixedType{"compression", 1},
                                    FixedType{"deepImageState", 1},
                                    FixedType{"double", 8},
                                    FixedType{"envmap", 1},
                                    FixedType{"float", 4},
                                    FixedType{"int", 4},
                                    FixedType{"keycode", 28},
                                    FixedType{"lineOrder", 1},
                                    FixedType{"m33d", 72},
                                    FixedType{"m33f", 36},
                                    FixedType{"m44d", 128},
                                    FixedType{"m44f", 64},
                                    FixedType{"rational", 8},
                                    FixedType{"tiledesc", 9},
                                    FixedType{"timecode", 8},
                                    FixedType{"v2d", 16},
                                    FixedType{"v2f", 8},
                                    FixedType{"v2i", 8},
                                    FixedType{"v3d", 24},
                                    FixedType{"v3f", 12},
                                    FixedType{"v3i", 12}};

/// Returns whether the value has exactly the size of its type.
bool has_its_size(std::string_view type, std::string_view value) {
    const auto fixed = std::ranges::find(kFixedTypes, type, &FixedType::name);
    if (fixed != kFixedTypes.end()) return value.size() == fixed->bytes;
    Bytes bytes(value);
    if (type == "chlist") {
        while (!bytes.name().empty()) bytes.take(16);
        return bytes.at_end() && !bytes.cut_off();
    }
    return true;
}

/// Returns the bytes of a pixel in all channels: 2 or 4 each, regardless of sampling.
uint64_t pixel_bytes(Bytes list) {
    constexpr int32_t kHalf = 1;
    uint64_t bytes = 0;
    while (!list.name().empty()) {
        bytes += list.number<int32_t>() == kHalf ? 2 : 4;
        list.take(12);
    }
    return bytes;
}

/// Reads an attribute that determines how much the library allocates. Returns why the library must not see
/// it; empty if it may.
std::string_view read_attribute(std::string_view name, std::string_view type, std::string_view value,
                                Part& part) {
    if (!has_its_size(type, value)) return "its header contradicts itself";
    Bytes bytes(value);
    if (name == "dataWindow" && type == "box2i") {
        std::array<int64_t, 4> box{};
        for (int64_t& side : box) side = bytes.number<int32_t>();
        if (box[2] < box[0] || box[3] < box[1]) return "its window is empty";
        part.width = static_cast<uint64_t>(box[2] - box[0] + 1);
        part.height = static_cast<uint64_t>(box[3] - box[1] + 1);
        if (part.width > kLargestSide || part.height > kLargestSide) return "it is too large";
    } else if (name == "channels" && type == "chlist") {
        part.pixel_bytes = pixel_bytes(bytes);
    } else if (name == "compression" && type == "compression") {
        const auto number = bytes.number<uint8_t>();
        if (number >= kChunkLines.size()) return "its compression is unknown";
        part.chunk_lines = kChunkLines[number];
    } else if (name == "tiles" && type == "tiledesc") {
        part.tile_width = bytes.number<uint32_t>();
        part.tile_height = bytes.number<uint32_t>();
        if (part.tile_width == 0 || part.tile_height == 0) return "its tiles are empty";
    } else if (name == "chunkCount" && type == "int") {
        part.said_chunks = bytes.number<uint32_t>();
    } else if (type == "preview") {
        const uint64_t width = bytes.number<uint32_t>(), height = bytes.number<uint32_t>();
        if (std::max(width, height) > kLargestSide || value.size() != 8 + 4 * width * height)
            return "its preview is not as large as it says";
    } else if (type == "idmanifest") {
        return "it has a list of identifiers";
    } else if (name == "type" && value.starts_with("deep")) {
        return "it is a deep picture";
    }
    return bytes.cut_off() ? "its header contradicts itself" : std::string_view();
}

std::string_view check_part(const Part& part, uint64_t file_bytes) {
    const uint64_t width = std::min(part.tile_width ? part.tile_width : part.width, part.width);
    const uint64_t lines = std::min(part.tile_width ? part.tile_height : part.chunk_lines, part.height);
    if (width == 0 || lines == 0) return "its window is missing";
    const uint64_t chunks = (part.width + width - 1) / width * ((part.height + lines - 1) / lines);
    if (std::max(chunks, part.said_chunks) > file_bytes / sizeof(uint64_t))
        return "it is too short for the table of its chunks";
    if (part.width * lines * part.pixel_bytes > kMostChunkBytes) return "its chunks are larger than 64 MiB";
    return {};
}

/// Returns what is wrong; empty if nothing is.
std::string_view problem_of(Bytes header, uint64_t file_bytes) {
    header.take(4);  // magic number
    const auto version = header.number<uint32_t>();
    if (version & kDeep) return "it is a deep picture";
    for (size_t parts = 0;; ++parts) {
        Part part;
        bool any = false;
        for (auto name = header.name(); !name.empty(); name = header.name(), any = true) {
            const auto type = header.name();
            const auto value = header.take(header.number<uint32_t>());
            if (header.cut_off()) break;
            if (const auto problem = read_attribute(name, type, value, part); !problem.empty())
                return problem;
        }
        if (header.cut_off()) return "its header is cut off, or larger than 16 MiB";
        if (!any && parts > 0) return {};  // an empty header ends the list of parts
        if (const auto problem = check_part(part, file_bytes); !problem.empty()) return problem;
        if (!(version & kMultiPart)) return {};
        if (parts >= kMostParts) return "it has over 1000 parts";
    }
}

}  // namespace

Result<void> check_exr_header(const ByteSource& file) {
    std::vector<char> front(std::min(file.size(), kMostHeaderBytes));
    LUCARNE_TRY(file.read_at(0, std::as_writable_bytes(std::span(front))));
    constexpr std::string_view kMagic = "\x76\x2f\x31\x01";
    if (!std::string_view(front.data(), front.size()).starts_with(kMagic))
        return rejected(file.path().string(), "is no EXR picture");
    const auto problem = problem_of(Bytes({front.data(), front.size()}), file.size());
    if (problem.empty()) return {};
    return rejected(file.path().string(), fmt::format("is no usable EXR picture ({})", problem));
}

}  // namespace lucarne::io
