#pragma once

#include <cstdint>
#include <span>
#include <vector>

#include <glm/vec3.hpp>

#include "gi/engines/reference/path_sums.h"
#include "gi/tracing/illumination.h"
#include "io/core/random.h"

namespace lucarne {
class Progress;
}

namespace lucarne::gi::reference {

using tracing::Illumination;
using tracing::SurfelSampler;
using tracing::SurfelTracer;

struct PathSettings {
    uint32_t bounces = 1;
    int32_t only_bounce = -1;  ///< >= 0: just that one
    uint32_t samples = 64;     ///< paths a start
    uint64_t seed = 1;
    uint64_t frame = 0;  ///< each frame takes paths of its own
    /// Whether paths are led to what sharp lights light; else the BRDF alone has to find it. Same mean.
    bool sample_lit = true;
};

/// A point whose outgoing radiance is wanted: what a G-buffer texel says of it.
struct Start {
    glm::vec3 position;
    glm::vec3 normal;  ///< unit, toward the viewer
    glm::vec3 viewer;  ///< unit, from the point to the viewer
    glm::vec3 albedo;  ///< linear, before the material's scale
    float radius = 0;  ///< of its surfel; 0: there is nothing here, its radiance is 0
    uint32_t material = 0;
};

/// Unidirectional path tracing over surfels. Lights, environment and emitting surfels are sampled where a
/// path reflects (next event estimation), and so are surfels that sharp lights light; what the BRDF's own
/// directions meet counts as well, all weighted by the balance heuristic (Veach & Guibas 1995).
///
/// Bounces are orders of the Neumann series L = sum_k T^k L0 (Kajiya 1986): L0 is emission and the light that
/// comes from lights and the environment and is reflected once (bounce 0), and each bounce is one more
/// reflection by the transport operator T. Emission therefore counts like directly reflected light: seen
/// directly it is bounce 0.
class PathTracer {
 public:
    /// `illumination` outlives the tracer.
    PathTracer(const Illumination& illumination, const PathSettings& settings);

    /// One a start. The numbers follow from (seed, frame, start's index, path) alone, so that they are the
    /// same for any number of threads. Starts that are done are added to `progress` if there is one.
    std::vector<PathSums> trace(std::span<const Start> starts, Progress* progress = nullptr) const;

    /// Of one start; `index` chooses its random numbers.
    PathSums trace(const Start& start, uint64_t index) const;

 private:
    struct Vertex;
    struct Ray;
    Vertex vertex(const Start& start) const;
    bool counts(uint32_t bounce) const;
    bool anything_random() const;
    glm::vec3 before_what_hides(const glm::vec3& origin, const Start& start) const;
    glm::vec3 sharp_light(const Vertex& vertex) const;
    glm::vec3 soft_light(const Vertex& vertex, Random& random) const;
    glm::vec3 soft_light_along(const Vertex& vertex, const Ray& ray) const;
    Ray cast(const Vertex& from, const glm::vec3& direction, float pdf) const;
    Vertex arrive(const Vertex& from, const Ray& ray) const;
    SurfelSampler::Density density(const SurfelSampler& sampler, const Vertex& from, const Ray& ray,
                                   uint32_t drawn = kNoSurfel) const;
    glm::vec3 sampled_surfel(const SurfelSampler& sampler, const Vertex& vertex, Random& random) const;
    glm::vec3 met_light(const Vertex& from, const Vertex& at, const Ray& ray) const;
    glm::vec3 path(const Vertex& first, Random& random) const;

    const Illumination& light_;
    const SurfelTracer& surfels_;
    PathSettings settings_;
    uint32_t last_;  // bounce that counts
};

}  // namespace lucarne::gi::reference
