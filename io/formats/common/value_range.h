#pragma once

#include "io/points.h"

// From where to where intensities go that have no 16 bits of their own.
namespace lucarne::io {

struct Range {
    double low = 0, high = 1;  ///< low < high
};

/// What the format of a scan, or its file, says; empty where neither does.
std::optional<Range> stated_range(const FormatNotes& notes);

/// Looks at the values of an attribute of one component.
class RangeSearch {
 public:
    RangeSearch(const Schema& schema, const Attribute& attribute)
        : stride_(schema.stride), attribute_(attribute) {}

    /// True: further values may change what is found.
    bool add(std::span<const std::byte> records);
    /// Empty where whole numbers of 16 bits are all there is, or no two values differ.
    std::optional<Range> found() const;

 private:
    uint32_t stride_;
    Attribute attribute_;
    double low_ = 0, high_ = 0;
    bool any_ = false, whole_ = true;
};

}  // namespace lucarne::io
