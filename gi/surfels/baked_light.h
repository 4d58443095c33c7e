#pragma once

#include <memory>
#include <vector>

#include <glm/vec3.hpp>

#include "octree/tree/source.h"

namespace lucarne::gi {

/// How bright the points' colours are hereabouts, against all of them: an estimate of the light that a scan
/// was taken in. Luminances, linear, are averaged over cells of 1/48 of the scan's longest side and blurred
/// over 5 cells each way; surfaces whose paint differs on that scale are flattened as well (Land & McCann
/// 1971, "Lightness and retinex theory": light varies slowly, paint fast).
class BakedLight {
 public:
    /// Of the coarsest nodes, which are an even sample; the same on every run. Errors: a node that cannot be
    /// read.
    static Result<BakedLight> measured(const octree::NodeSource& source);
    /// For positions in a part's own unit, of which `scale` source units are one.
    BakedLight in_unit(double scale) const;

    /// What a linear colour there is to be multiplied by, 1/8 to 8, where `share` of the light is divided
    /// out.
    double factor(const glm::dvec3& position, double share) const;

 private:
    double mean_at(const glm::dvec3& position) const;

    glm::dvec3 min_{0.0};
    double cell_ = 1;
    glm::ivec3 size_{0};
    double mean_ = 0;                                  ///< of all; 0: no colours
    std::shared_ptr<const std::vector<float>> means_;  ///< x fastest; 0: no points there
};

}  // namespace lucarne::gi
