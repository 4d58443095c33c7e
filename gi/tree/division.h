#pragma once

#include <array>
#include <cstddef>
#include <cstdint>
#include <span>
#include <vector>

#include <glm/vec3.hpp>

#include "gi/shared/flat_surfel.h"

namespace lucarne::gi {

/// A surfel that the tree holds, decoded once for all levels: they stand in the order of the tree, where
/// those of a node are read one after the other.
struct PlacedSurfel {
    glm::vec3 position, normal;
    float radius, area;  ///< m, m^2; the area of its disc if the surfel has none
    glm::vec3 edge;      ///< the line at which its disc ends (gi/shared/edge.h), 1/m; zero: none
    uint32_t index;      ///< its number
    uint32_t side;       ///< of a cube: the one to which its normal is nearest, 0 to 5
};

struct Range {
    size_t first = 0, last = 0;
    size_t count() const { return last - first; }
};

/// Up to eight ranges one after the other.
struct Parts {
    std::array<Range, 8> ranges;
    size_t count = 0;
    void add(const Range& range) { ranges[count++] = range; }
};

/// Returns the surfels that have a disc in the order of their sides, and of their numbers within a side.
std::vector<PlacedSurfel> place_surfels(std::span<const FlatSurfel> surfels);

/// Divides a range of at least two surfels into up to eight, and puts the surfels in their order: by side if
/// there is more than one, then again and again the part that is longest, across its length. Parts have about
/// the same size, and ranges of up to eight become single surfels. `level`: how often surfels have been
/// divided before; from kMedianLevel on parts have the same number of surfels instead, so that trees end for
/// any input.
Parts divide(std::span<PlacedSurfel> surfels, const Range& range, size_t level);
inline constexpr size_t kMedianLevel = 32;

}  // namespace lucarne::gi
