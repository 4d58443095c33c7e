#pragma once

#include <memory>
#include <vector>

#include <glm/vec3.hpp>

#include "octree/tree/source.h"

namespace lucarne::gi {

/// An estimate of the light in which a scan was taken: how bright the colours around a point are, compared
/// with all of them. Linear luminances are averaged over cells of 1/48 of the scan's longest side and
/// blurred over 5 cells along each axis. Surfaces whose paint differs on that scale are flattened as well
/// (Land & McCann 1971, "Lightness and retinex theory": light varies slowly, paint fast).
class BakedLight {
 public:
    /// Measures the light on the coarsest nodes, which are an even sample; the result is the same on every
    /// run. Errors: a node that cannot be read.
    static Result<BakedLight> measured(const octree::NodeSource& source);
    /// Returns the same light for positions in a part's own unit; one such unit is `scale` source units.
    BakedLight in_unit(double scale) const;

    /// Returns the factor, 1/8 to 8, by which a linear colour at `position` has to be multiplied to divide
    /// out `share` of the light.
    double factor(const glm::dvec3& position, double share) const;

 private:
    double mean_at(const glm::dvec3& position) const;

    glm::dvec3 min_{0.0};
    double cell_ = 1;
    glm::ivec3 size_{0};
    double mean_ = 0;                                  ///< mean over all points; 0: no colours
    std::shared_ptr<const std::vector<float>> means_;  ///< means of the cells, x fastest; 0: no points there
};

}  // namespace lucarne::gi
