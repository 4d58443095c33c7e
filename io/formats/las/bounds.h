#pragma once

#include <array>
#include <cstddef>
#include <cstdint>
#include <optional>
#include <utility>

#include "io/formats/las/header.h"

namespace lucarne::io::las {

/// Returns the lowest and highest corner that a header states, right or wrong. Empty if they form no box.
std::optional<std::array<glm::dvec3, 2>> stated_box(const Header& header);

/// Detects impossible points: they lie farther outside the box that the header states than its longest side.
/// Headers often state a box that is slightly wrong. Bytes that were never written or were decoded wrongly
/// rarely give a point near the box.
class StatedBounds {
 public:
    explicit StatedBounds(const Header& header);
    bool stated() const { return stated_; }  ///< otherwise nothing is outside

    /// Looks at every `step`th record (each begins with x, y, z as 32-bit integers). Returns the index of the
    /// first that is far outside; nothing if there is none, or if the header states no box.
    std::optional<size_t> outside(const std::byte* records, size_t count, size_t stride,
                                  size_t step = 1) const;

 private:
    std::array<std::pair<int32_t, int32_t>, 3> range_;  ///< allowed integers of each axis
    bool stated_ = false;
};

}  // namespace lucarne::io::las
