#pragma once

#include <functional>
#include <memory>
#include <optional>
#include <span>
#include <vector>

#include "gi/shared/material.h"
#include "gi/tracing/light_sampling.h"
#include "gi/tracing/surfel_sampler.h"
#include "gi/tracing/surfel_tracer.h"

namespace lucarne::gi::tracing {

/// Every source of light in a scene, ready to be sampled: lights, environment, and the surfels whose
/// material has an emission.
///
/// SurfelSampler draws surfels of two kinds: surfels that emit, in proportion to area * luminance of the
/// emission, and surfels that sharp lights illuminate, in proportion to the light that they reflect. Without
/// the latter only chance would find the small bright patch beside a lamp.
class Illumination {
 public:
    /// `surfels` must outlive this.
    Illumination(const SurfelTracer& surfels, std::vector<Material> materials, std::vector<Light> lights,
                 std::shared_ptr<const Environment> environment);

    const SurfelTracer& surfels() const { return surfels_; }
    /// Returns the material with this index; plain white if there is none.
    const Material& material(uint32_t index) const;

    std::span<const Light> sharp_lights() const { return sharp_; }
    std::span<const Light> soft_lights() const { return soft_; }  ///< lights that have to be sampled
    const EnvironmentSampler* environment() const { return environment_ ? &*environment_ : nullptr; }
    /// Returns whether the light of a sharp light, which comes from the direction `in`, reaches the origin
    /// of a ray.
    bool arrives(const Light& sharp, const glm::vec3& origin, const glm::vec3& in) const;
    bool anything_soft() const { return environment_ || !soft_.empty(); }

    const SurfelSampler& emitters() const { return emitters_; }
    const SurfelSampler& lit_surfels() const { return lit_; }

 private:
    // Weights with which surfels are drawn.
    double emitted(uint32_t surfel) const;
    double lit(uint32_t surfel) const;
    SurfelSampler sampler_of(const std::function<double(uint32_t)>& weight) const;

    const SurfelTracer& surfels_;
    std::vector<Material> materials_;
    std::vector<Light> sharp_, soft_;
    std::optional<EnvironmentSampler> environment_;
    SurfelSampler emitters_, lit_;
};

}  // namespace lucarne::gi::tracing
