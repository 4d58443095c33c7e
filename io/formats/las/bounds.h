#pragma once

#include <array>
#include <cstddef>
#include <cstdint>
#include <optional>
#include <utility>

#include "io/formats/las/header.h"

namespace lucarne::io::las {

/// The box that a header states, true or not: the least, the largest. None where what it states is no box.
std::optional<std::array<glm::dvec3, 2>> stated_box(const Header& header);

/// Tells points that cannot be from those of a scan: they lie farther outside the box that the header states
/// than that is long. Small lies about the box are common, bytes that were never written or decoded amiss are
/// seldom near.
class StatedBounds {
 public:
    explicit StatedBounds(const Header& header);

    /// The first of every `step`th record (x, y, z as 32-bit integers in front) that is far outside; none
    /// where all are inside or the header states no box.
    std::optional<size_t> outside(const std::byte* records, size_t count, size_t stride,
                                  size_t step = 1) const;

 private:
    std::array<std::pair<int32_t, int32_t>, 3> range_;  ///< of the integers
    bool stated_ = false;
};

}  // namespace lucarne::io::las
