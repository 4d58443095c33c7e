#pragma once

#include <array>
#include <cstddef>
#include <cstdint>
#include <optional>
#include <utility>

#include "io/formats/las_header.h"

namespace lucarne::io::las {

/// Tells points that cannot be from those of a scan: they lie farther outside the box that the header states than that
/// is long. Small lies about the box are common, bytes that were never written or decoded amiss are seldom near.
class StatedBounds {
 public:
    explicit StatedBounds(const Header& header);
    /// Whether what the header states is a box at all.
    bool sound() const { return sound_; }

    /// The first of every `step`th record (x, y, z as 32-bit integers in front) that is far outside; none where all are
    /// inside or the header states no box.
    std::optional<size_t> outside(const std::byte* records, size_t count, size_t stride, size_t step = 1) const;

 private:
    std::array<std::pair<int32_t, int32_t>, 3> range_;  ///< of the integers
    bool sound_ = false, stated_ = false;
};

}  // namespace lucarne::io::las
