#pragma once

#include <cstdint>
#include <span>

#include <glm/vec3.hpp>

#include "gi/engines/paths/bake.h"
#include "gi/engines/paths/point_sky.h"
#include "gi/gather/gather_sky.h"
#include "gi/host_frame.h"
#include "gi/tracing/surfel_tracer.h"

namespace lucarne::gi::paths {

/// The sky at pixels whose gathering points do not agree about it, as at windows, or are none of their
/// surface: by rays, half of them to where these points see it.
class SkyRays {
 public:
    /// `at_points`: the irradiance of the points by the sky, as pixels interpolate it, W/m^2. The references
    /// must outlive it.
    SkyRays(const tracing::SurfelTracer& tracer, const GatherSky& sky, const PointSky& point_sky,
            std::span<const glm::vec3> at_points)
        : tracer_(tracer), sky_(sky), point_sky_(point_sky), at_points_(at_points) {}

    /// Returns what has to be added to the interpolated irradiance of a place, W/m^2. `start`: of its rays;
    /// `about`: its gathering points; `key` chooses the rays.
    glm::vec3 correction(const SurfacePoint& place, const glm::vec3& start, std::span<const PointShare> about,
                         uint64_t key) const;

 private:
    /// Returns whether the points are unreliable for the sky at a place.
    bool are_unsure(const SurfacePoint& place, std::span<const PointShare> about) const;

    const tracing::SurfelTracer& tracer_;
    const GatherSky& sky_;
    const PointSky& point_sky_;
    std::span<const glm::vec3> at_points_;
};

}  // namespace lucarne::gi::paths
