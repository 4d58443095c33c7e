#pragma once

#include <cstdint>
#include <span>
#include <vector>

#include <glm/vec3.hpp>

#include "gi/reference/surfel_tracer.h"
#include "gi/shared/light.h"
#include "gi/shared/material.h"
#include "io/core/random.h"

namespace lucarne::gi::reference {

struct PathSettings {
    uint32_t bounces = 1;
    int32_t only_bounce = -1;  ///< >= 0: just that one
    uint32_t samples = 64;     ///< paths a start
    uint64_t seed = 1;
    uint64_t frame = 0;  ///< each frame takes paths of its own
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

struct Estimate {
    glm::vec3 radiance{0.0f};  ///< W/(sr m^2)
    float variance = 0;        ///< of the luminance of `radiance`, estimated from its paths
};

/// Unidirectional path tracing over surfels with next event estimation of spots.
///
/// Bounces are orders of the Neumann series L = sum_k T^k L0 (Kajiya 1986): L0 is emission and the light that
/// spots reflect off a surface directly (bounce 0), and each bounce is one more reflection by the transport
/// operator T. Emission therefore counts like directly reflected light: seen directly it is bounce 0.
class PathTracer {
 public:
    /// `materials` may be empty: then every surfel is a white-scaled diffuse one. All spans outlive the
    /// tracer.
    PathTracer(const SurfelTracer& surfels, std::span<const Light> lights,
               std::span<const Material> materials, const PathSettings& settings);

    /// One estimate a start. The numbers follow from (seed, frame, start's index, path) alone, so that they
    /// are the same for any number of threads.
    std::vector<Estimate> trace(std::span<const Start> starts) const;

    /// Of one start; `index` chooses its random numbers.
    Estimate trace(const Start& start, uint64_t index) const;

 private:
    struct Vertex;
    Vertex vertex(const Start& start) const;
    bool counts(uint32_t bounce) const;
    glm::vec3 before_what_hides(const glm::vec3& origin, const Start& start) const;
    glm::vec3 own_light(const Vertex& vertex) const;
    glm::vec3 path(const Vertex& first, Random& random) const;

    const SurfelTracer& surfels_;
    std::span<const Light> lights_;
    std::span<const Material> materials_;
    PathSettings settings_;
};

/// Rec. 709.
inline float luminance(const glm::vec3& c) {
    return 0.2126f * c.x + 0.7152f * c.y + 0.0722f * c.z;
}

/// Mean luminance of estimates and its standard error, in double and in order.
struct MeanLuminance {
    double mean = 0, standard_error = 0;
};
MeanLuminance mean_luminance(std::span<const Estimate> estimates);

}  // namespace lucarne::gi::reference
