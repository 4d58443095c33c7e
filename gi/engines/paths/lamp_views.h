// What lamps will shine on, if one knows where they will be.
#pragma once

#include <cstddef>
#include <cstdint>
#include <span>
#include <vector>

#include <glm/vec3.hpp>

#include "gi/engines/paths/surfaces.h"
#include "gi/frame.h"

namespace lucarne::gi::paths {

/// Returns the middles of the cells of a regular grid in a box, m: four along its longest side, and about as
/// far apart along the others.
std::vector<glm::vec3> lamp_positions(const Bounds& region);

/// Looks from a grid in the region where lamps will be (Yue et al. 2007, section 5.1), and finds how much of
/// the light of a lamp there each leaf may get.
class LampViews {
 public:
    /// `leaf_of`: each side's leaf. The references must outlive it.
    LampViews(const Surfaces& surfaces, std::span<const uint32_t> leaf_of, size_t leaves,
              const Bounds& region);
    /// Looks from some more positions. Returns whether any are left.
    bool advance();
    /// Of each leaf: the largest share of all directions in which it is seen from one of the positions.
    const std::vector<float>& seen() const { return seen_; }

 private:
    const Surfaces& surfaces_;
    std::span<const uint32_t> leaf_of_;
    std::vector<glm::vec3> positions_;
    size_t next_ = 0;  ///< position
    std::vector<float> seen_;
};

/// Raises the numbers of entry points of leaves until a lamp at any of the positions of LampViews sees about
/// `enough`, evenly in all directions, unless that would be more than `most` together: then as many of these
/// as are allowed. No leaf gets more than `limits` says.
void add_seen(std::span<uint32_t> counts, std::span<const float> seen, std::span<const uint32_t> limits,
              double enough, double most);

}  // namespace lucarne::gi::paths
