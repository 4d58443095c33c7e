#pragma once

#include <atomic>
#include <cstdint>
#include <span>
#include <vector>

#include <glm/vec3.hpp>

#include "gi/engines/reference/path_sums.h"
#include "gi/host_frame.h"
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
    int32_t only_bounce = -1;  ///< >= 0: this bounce alone
    uint32_t samples = 64;     ///< paths a start
    uint64_t seed = 1;
    uint64_t frame = 0;  ///< each frame has paths of its own
    /// Whether paths sample the surfels that sharp lights illuminate; otherwise only the BRDF finds them.
    /// The mean is the same.
    bool sample_lit = true;
};

/// A point whose outgoing radiance is computed.
using Start = SurfacePoint;

/// Unidirectional path tracing over surfels. At each vertex a path samples lights, environment, emitting
/// surfels (next event estimation) and surfels that sharp lights illuminate. The light that the BRDF's own
/// directions find counts as well; all are weighted by the balance heuristic (Veach & Guibas 1995).
///
/// Bounces are orders of the Neumann series L = sum_k T^k L0 (Kajiya 1986). L0 is emission, plus the light
/// of lights and the environment reflected once (bounce 0). Each bounce is one more reflection by the
/// transport operator T. Emission therefore counts like directly reflected light: seen directly it is bounce
/// 0.
class PathTracer {
 public:
    /// `illumination` must outlive the tracer.
    PathTracer(const Illumination& illumination, const PathSettings& settings);

    /// Returns one sum per start. Random numbers depend only on (seed, frame, index of the start, path), so
    /// the result is the same for any number of threads. Adds finished starts to `progress` unless it is
    /// null. Leaves out the rest once `stop` is true (unless it is null).
    std::vector<PathSums> trace(std::span<const Start> starts, Progress* progress = nullptr,
                                const std::atomic<bool>* stop = nullptr) const;

    /// Returns the sum of one start; `index` selects its random numbers. Leaves out further paths once `stop`
    /// is true (unless it is null).
    PathSums trace(const Start& start, uint64_t index, const std::atomic<bool>* stop = nullptr) const;

 private:
    struct Vertex;
    struct Ray;
    Vertex vertex(const Start& start) const;
    bool counts(uint32_t bounce) const;
    bool anything_random() const;
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
    uint32_t last_;  // last bounce that counts
};

}  // namespace lucarne::gi::reference
