#pragma once

#include <memory>
#include <optional>
#include <span>
#include <vector>

#include "gi/reference/alias_table.h"
#include "gi/reference/light_sampling.h"
#include "gi/reference/surfel_tracer.h"
#include "gi/shared/material.h"

namespace lucarne::gi::reference {

/// Everything that shines in a scene, ready to be sampled: lights, environment, and the surfels whose
/// material has an emission.
///
/// Discs overlap, so that a point of a surface belongs to several. What counts is what rays see: the nearest
/// disc. A surfel is drawn in proportion to area * luminance of its emission, a point evenly on its disc, and
/// the draw counts only where the ray to that point meets this very surfel first. So each direction belongs
/// to one surfel, its density is emitter_pdf() of that surfel, and the same density weighs the directions
/// that the BRDF drew (multiple importance sampling, Veach & Guibas 1995). It holds for any overlap, any
/// radius and any area; where areas are wrong only noise grows.
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
    bool anything_soft() const { return environment_ || !soft_.empty(); }

    bool has_emitters() const { return !emitters_.empty(); }
    struct Emitter {
        uint32_t surfel;
        glm::vec3 point;  ///< on its disc
    };
    Emitter sample_emitter(Random& random) const;
    /// Density, 1/sr, of the direction to a point of a surfel's disc at `distance`, seen under `cosine`.
    float emitter_pdf(const Surfel& surfel, float distance, float cosine) const;

 private:
    double emitted(const Surfel& surfel) const;

    const SurfelTracer& surfels_;
    std::vector<Material> materials_;
    std::vector<Light> sharp_, soft_;
    std::optional<EnvironmentSampler> environment_;
    std::vector<uint32_t> emitting_;  // surfels, in the order of emitters_
    AliasTable emitters_;
};

}  // namespace lucarne::gi::reference
