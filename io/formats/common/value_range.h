#pragma once

#include "io/points.h"

// The range of intensities that are not stored as 16-bit numbers already.
namespace lucarne::io {

struct Range {
    double low = 0, high = 1;  ///< low < high
};

/// Returns the range that a scan's file or its format states; empty if neither does.
std::optional<Range> stated_range(const FormatNotes& notes);

/// Finds the range of an attribute of one component from its values.
class RangeSearch {
 public:
    RangeSearch(const Schema& schema, const Attribute& attribute)
        : stride_(schema.stride), attribute_(attribute) {}

    /// Looks at more records. Returns true if further values may still change the result.
    bool add(std::span<const std::byte> records);
    /// Returns the range; empty if all values are whole numbers of 16 bits, or if no two values differ.
    std::optional<Range> found() const;

 private:
    uint32_t stride_;
    Attribute attribute_;
    double low_ = 0, high_ = 0;
    bool any_ = false, whole_ = true;
};

}  // namespace lucarne::io
