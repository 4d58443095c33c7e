#pragma once

#include <span>

#include "io/points.h"

// How many bits of a colour component are in use (ScanInfo::color_bits): one rule for all formats. What a
// file states comes first (a comment of Lucarne, E57's limits); otherwise the values decide, never the type
// of the field: many 16-bit fields, 32-bit integers and floats hold 0 to 255.
namespace lucarne::io {

/// Returns the colour bits for the largest component of a colour: for whole numbers 8 up to 255, else 16; for
/// real numbers 0 up to 1 (and for no value above 0), 8 up to 255, else 16.
constexpr uint32_t color_bits_of(double largest, bool whole) {
    return largest > 255 ? 16 : whole || largest > 1 ? 8 : 0;
}

/// Finds the colour bits of an attribute from its values. A part of the values may give fewer bits than all
/// of them, never more.
class ColorDepth {
 public:
    explicit ColorDepth(const Schema& schema);

    void add(std::span<const std::byte> records);  ///< whole records of the schema
    /// Returns the colour bits that the values so far need; 8 without colours.
    uint32_t bits() const { return color_bits_of(largest_, whole_); }
    /// Whether values can still change the result.
    bool open() const { return open_ && largest_ <= 255; }

 private:
    uint32_t stride_ = 0, offset_ = 0;
    ScalarType type_ = ScalarType::u8;
    bool open_ = false, whole_ = true;
    double largest_ = 0;
};

/// Returns the colour bits of a scan from a sample: points spread over a file that can seek, otherwise the
/// fronts of its parts. Reads a few hundred KiB of a plain file. What cannot be read is left out: the pass
/// over the points will report it.
uint32_t sampled_color_bits(const PointSource& scan);

}  // namespace lucarne::io
