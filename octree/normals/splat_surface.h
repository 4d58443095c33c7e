#pragma once

#include <glm/vec3.hpp>

#include "io/points.h"

namespace lucarne::octree {

/// Combines what Gaussian splats say of themselves (io::names::splat_axis and splat_radius) with what is
/// estimated from their neighbours. Points that are no splats, or say nothing, keep the estimates.
class SplatSurface {
 public:
    explicit SplatSurface(const io::Schema& schema);

    /// Returns the splat's axis, turned to the side of the `estimated` normal (zero: none), which was
    /// oriented with the whole surface. Upward where there is none.
    glm::vec3 normal(const std::byte* record, const glm::vec3& estimated) const;
    /// Returns a share of the surface in faces of `face` square units. A splat's size replaces a share that
    /// is unknown (0), and bounds the others: the disc gets no larger than twice the splat, which is
    /// transparent there. Outliers stay outliers: trained scenes have many splats in the air.
    float area(const std::byte* record, float estimated, double face) const;

 private:
    const io::Attribute *axis_ = nullptr, *radius_ = nullptr;  ///< in the schema, which outlives this
};

}  // namespace lucarne::octree
