#pragma once

#include <span>
#include <vector>

#include "io/points.h"

namespace lucarne::octree::codec {

/// One number of a record, as a column of unsigned numbers.
struct Column {
    enum class Kind : uint8_t {
        integer,  ///< unchanged; signed ones with the sign bit flipped, so that order is kept
        real,  ///< IEEE 754 bits: negative ones inverted, others with the sign bit set, so that order is kept
        difference,  ///< a colour channel minus the record's green, plus 2^bits
        normal_low,
        normal_high  ///< the two 12-bit numbers of normal_oct
    };
    Kind kind = Kind::integer;
    uint32_t offset = 0;  ///< in the record
    uint32_t bytes = 0;   ///< bytes of the number itself: 1, 2, 4 or 8
    bool is_signed = false;
    uint32_t green = 0;  ///< difference: offset of green in the record
};

/// Returns a schema's columns, in the order in which payloads store them.
std::vector<Column> columns_of(const io::Schema& schema);

/// Reads the column's numbers from records of `stride` bytes.
void gather(const Column& column, std::span<const std::byte> records, uint32_t stride,
            std::vector<uint64_t>& values);
/// Writes the numbers back into the records. Columns must be scattered in order: a difference needs its
/// green, normal_high its normal_low.
void scatter(const Column& column, std::span<const uint64_t> values, std::span<std::byte> records,
             uint32_t stride);

}  // namespace lucarne::octree::codec
