#pragma once

#include <glm/vec3.hpp>

#include "io/points.h"

namespace lucarne::viewer {

inline constexpr double kMostBrightness = 4;

/// Estimates how bright a scan is, and the colour of the light in which its points were photographed: the
/// root mean square of each component of their linear colours ("shades of grey", Finlayson & Trezzi 2004,
/// with p = 2). A part of what this finds is paint, so only a share of it (as a power) counts as cast.
class ColourCast {
 public:
    /// Adds the colour of a point, if it has one. `white` is the largest value of its components
    /// (io::color_white()). Values outside 0 to `white` do not count.
    void add(const io::Schema& schema, const std::byte* record, double white);

    /// Whether a point has a colour other than black.
    bool coloured() const { return sum_ != glm::dvec3(0.0); }
    /// Returns a linear colour of luminance 1, the components at most 4 times apart; white if no point has a
    /// colour.
    glm::dvec3 result() const;
    /// Returns how many times as bright the colours have to be shown: 1 for most scans, up to kMostBrightness
    /// for scans that were photographed too dark to be seen.
    double brightness() const;

 private:
    glm::dvec3 sum_{0.0};
    uint64_t count_ = 0;
};

}  // namespace lucarne::viewer
