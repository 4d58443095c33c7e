#pragma once

#include <span>
#include <vector>

#include "io/points.h"

namespace lucarne::octree::codec {

/// One number of a record as a column of unsigned numbers.
struct Column {
    enum class Kind : uint8_t {
        integer,     ///< as it is, a signed one with its sign bit flipped, so that order is kept
        real,        ///< IEEE 754 bits: negative ones inverted, else the sign bit set, so that order is kept
        difference,  ///< of a colour to the green of the same record, plus 2^bits
        normal_low,
        normal_high  ///< the two 12-bit numbers of normal_oct
    };
    Kind kind = Kind::integer;
    uint32_t offset = 0;  ///< in the record
    uint32_t bytes = 0;   ///< 1, 2, 4, 8; of the number itself
    bool is_signed = false;
    uint32_t green = 0;  ///< difference: where green stands
};

/// The columns of a schema in the order in which payloads have them.
std::vector<Column> columns_of(const io::Schema& schema);

/// The column's numbers of records of `stride` bytes.
void gather(const Column& column, std::span<const std::byte> records, uint32_t stride,
            std::vector<uint64_t>& values);
/// Puts them back. Columns in order: a difference needs its green, normal_high its normal_low.
void scatter(const Column& column, std::span<const uint64_t> values, std::span<std::byte> records,
             uint32_t stride);

}  // namespace lucarne::octree::codec
