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

/// Everything that shines in a scene, ready to be sampled: lights, environment, and the surfels whose
/// material has an emission.
///
/// What shines is drawn by SurfelSampler: surfels that emit in proportion to area * luminance of their
/// emission, and surfels that sharp lights light in proportion to the light that these make them reflect.
/// Without the latter, the small bright patch beside a lamp is met by chance alone.
class Illumination {
 public:
    /// `surfels` outlives it.
    Illumination(const SurfelTracer& surfels, std::vector<Material> materials, std::vector<Light> lights,
                 std::shared_ptr<const Environment> environment);

    const SurfelTracer& surfels() const { return surfels_; }
    /// The default, plain white, where there is none of this index.
    const Material& material(uint32_t index) const;

    std::span<const Light> sharp_lights() const { return sharp_; }
    std::span<const Light> soft_lights() const { return soft_; }  ///< those that have to be sampled
    const EnvironmentSampler* environment() const { return environment_ ? &*environment_ : nullptr; }
    /// Whether the light of a sharp one arrives at a ray's origin from the direction `in`.
    bool arrives(const Light& sharp, const glm::vec3& origin, const glm::vec3& in) const;
    bool anything_soft() const { return environment_ || !soft_.empty(); }

    const SurfelSampler& emitters() const { return emitters_; }
    const SurfelSampler& lit_surfels() const { return lit_; }

 private:
    // Weights of a surfel to be drawn.
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
