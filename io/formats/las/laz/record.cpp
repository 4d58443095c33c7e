#include "io/formats/las/laz/record.h"

#include <fmt/format.h>

namespace lucarne::io::laz {
namespace {

constexpr size_t kFixedBytes = 34, kItemBytes = 6;
auto refused(const std::string& file, const std::string& why) {
    return rejected(file, why, "recompress it with LASzip 3, or decompress it to LAS");
}

}  // namespace

std::vector<ItemLayout> items_of(const las::Header& header, uint16_t version) {
    const uint8_t format = header.point_format;
    const auto extra = static_cast<uint16_t>(header.record_length - las::record_bytes(format));
    std::vector<ItemLayout> items;
    if (las::extended_format(format)) {
        items.push_back({Item::point14, 30, version});
        if (format == 7) items.push_back({Item::color14, 6, version});
        if (format == 8) items.push_back({Item::color_nir14, 8, version});
        if (extra) items.push_back({Item::bytes14, extra, version});
    } else {
        items.push_back({Item::point10, 20, version});
        if (las::has_gps_time(format)) items.push_back({Item::gps_time, 8, version});
        if (las::has_color(format)) items.push_back({Item::color, 6, version});
        if (extra) items.push_back({Item::bytes, extra, version});
    }
    return items;
}

uint32_t record_bytes(const Compression& compression) {
    uint32_t bytes = 0;
    for (const ItemLayout& item : compression.items) bytes += item.bytes;
    return bytes;
}

Result<Compression> read_compression(const std::string& file, const las::Header& header) {
    const las::Vlr* record = header.find(kUser, kRecord);
    if (!record) return rejected(file, "has compressed points and no LASzip record that says how");
    const std::span<const std::byte> data = record->data;
    if (data.size() < kFixedBytes) return rejected(file, "has a LASzip record that is cut off");
    const auto compressor = load<uint16_t>(data.data()), coder = load<uint16_t>(data.data() + 2);
    const auto count = load<uint16_t>(data.data() + 32);
    if (coder != 0)
        return refused(file, fmt::format("is compressed with the unknown LASzip coder {}", coder));
    if (compressor == kUncompressed || compressor > kLayeredChunked)
        return refused(file, fmt::format("is compressed with the unknown LASzip compressor {}", compressor));
    if (data.size() < kFixedBytes + count * kItemBytes || count == 0)
        return rejected(file, "has a LASzip record that is cut off");
    Compression compression{
        compressor != kPointWise, compressor == kLayeredChunked, load<uint32_t>(data.data() + 12), {}};
    for (size_t i = 0; i < count; ++i) {
        const std::byte* at = data.data() + kFixedBytes + i * kItemBytes;
        compression.items.push_back(
            {static_cast<Item>(load<uint16_t>(at)), load<uint16_t>(at + 2), load<uint16_t>(at + 4)});
    }
    if (header.wave_bytes)
        return rejected(file,
                        fmt::format("has compressed point format {} (wave packets), which is not read",
                                    las::with_waves(header.point_format)),
                        "decompress it to LAS, whose wave packets are skipped");
    const uint16_t version = compression.items[0].version;
    const bool extended = las::extended_format(header.point_format);
    if (!extended && version < 2)
        return refused(file, fmt::format("is compressed by the old LASzip item version {}", version));
    if (extended ? version < 3 || version > 4 : version > 2)
        return refused(file, fmt::format("is compressed by the unknown LASzip item version {}", version));
    if (extended != compression.layered || compression.items != items_of(header, version))
        return rejected(file, "has a LASzip record that does not fit its point format");
    // LASzip takes no size for chunks of any size, and some writers of COPC rely on it.
    if (compression.chunked && compression.chunk_points == 0) compression.chunk_points = kVariableChunks;
    return compression;
}

}  // namespace lucarne::io::laz
