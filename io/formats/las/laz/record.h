#pragma once

#include <vector>

#include "io/formats/las/header.h"

// The record in which a LAZ file says how its points are compressed ("laszip encoded", 22204).
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

/// A part of a point record.
struct ItemLayout {
    Item item = Item::bytes;
    uint16_t bytes = 0;
    uint16_t version = 0;
    bool operator==(const ItemLayout&) const = default;
};

struct Compression {
    bool chunked = true;             ///< false: all points are one chunk, without a table
    bool layered = false;            ///< for point formats 6 to 8
    uint32_t chunk_points = 50'000;  ///< kVariableChunks: the chunk table states them
    std::vector<ItemLayout> items;
};

/// Returns the items of the header's point format and extra bytes.
std::vector<ItemLayout> items_of(const las::Header& header, uint16_t version);

/// Returns the bytes of all items together.
uint32_t record_bytes(const Compression& compression);

/// Reads the record and checks it against the point format and the record length. Errors: no such record, an
/// unknown coder, a compressor or an item that cannot be read (the message names it), items that do not
/// belong to the point format.
Result<Compression> read_compression(const std::string& file, const las::Header& header);

}  // namespace lucarne::io::laz
