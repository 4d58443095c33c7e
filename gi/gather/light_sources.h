#pragma once

#include <cstdint>
#include <span>
#include <vector>

#include <glm/vec3.hpp>

#include "gi/surfels/side_light.h"

namespace lucarne::gi {

/// One of the two lobes of a side of a surfel, which sends light out.
struct LightSource {
    size_t traced;    ///< the surfel's number among those of a TracedTree
    uint32_t surfel;  ///< its number in the light cut
    bool back, specular;
};

/// Everything that sends light out, by the flux that it sends.
class LightSources {
 public:
    /// `surfels`: of each traced surfel its number in `light`, what each sends out evenly, and in `lobes`
    /// (lobe.h). `areas`: of each side, the back's after the front's, m^2. All must outlive this.
    LightSources(std::span<const uint32_t> surfels, std::span<const float> areas,
                 std::span<const SideLight> light, const SideLobes& lobes);

    double total() const { return ends_.empty() ? 0 : ends_.back(); }  ///< W, the mean of the three colours
    /// Returns the source at a share of the total, 0 to 1; there must be any.
    LightSource at(double share) const;
    /// Returns what a source sends out of each area, W/m^2. Of specular lobes a part may be below the
    /// surface.
    glm::vec3 exitance(const LightSource& source) const;
    glm::vec3 flux(const LightSource& source) const;  ///< W

 private:
    LightSource source(size_t i) const;

    std::span<const uint32_t> surfels_;
    std::span<const float> areas_;
    std::span<const SideLight> light_;
    const SideLobes& lobes_;
    const size_t kinds_;  ///< of sources a surfel: of two sides, of one lobe or two
    std::vector<double> ends_;
};

}  // namespace lucarne::gi
