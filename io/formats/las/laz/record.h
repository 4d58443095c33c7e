#pragma once

#include <vector>

#include "io/formats/las/header.h"

// The record by which a LAZ file says how its points are compressed ("laszip encoded", 22204).
namespace lucarne::io::laz {

inline constexpr std::string_view kUser = "laszip encoded";
inline constexpr uint16_t kRecord = 22204;
inline constexpr uint32_t kVariableChunks = UINT32_MAX;

enum Compressor : uint16_t { kUncompressed = 0, kPointWise = 1, kPointWiseChunked = 2, kLayeredChunked = 3 };

enum class Item : uint16_t {
    bytes = 0,
    point10 = 6,
    gps_time = 7,
    color = 8,
    point14 = 10,
    color14 = 11,
    color_nir14 = 12,
    bytes14 = 14
};

/// Part of a point record.
struct ItemLayout {
    Item item = Item::bytes;
    uint16_t bytes = 0;
    uint16_t version = 0;
    bool operator==(const ItemLayout&) const = default;
};

struct Compression {
    bool chunked = true;             ///< else all points are one chunk, without a table
    bool layered = false;            ///< point formats 6 to 8
    uint32_t chunk_points = 50'000;  ///< kVariableChunks: the chunk table tells
    std::vector<ItemLayout> items;
};

/// The items of the header's point format and extra bytes.
std::vector<ItemLayout> items_of(const las::Header& header, uint16_t version);

/// Of all items together.
uint32_t record_bytes(const Compression& compression);

/// What the record says, checked against the point format and the length of the records. Errors: no such
/// record, another coder, a compressor or an item that is not read (its name is in the reason), items that
/// are not the point format's.
Result<Compression> read_compression(const std::string& file, const las::Header& header);

}  // namespace lucarne::io::laz
