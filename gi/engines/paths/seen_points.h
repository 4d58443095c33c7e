#pragma once

#include <span>
#include <vector>

#include <glm/vec3.hpp>

#include "gi/engines/paths/bake.h"
#include "gi/host_frame.h"
#include "gi/tracing/surfel_tracer.h"

namespace lucarne::gi::paths {

/// Returns where the rays of a place that a picture shows start: above it, on the viewer's side of what hides
/// it (tracing::before_what_hides()).
glm::vec3 start_of_rays(const tracing::SurfelTracer& tracer, const SurfacePoint& place);

/// Gathering points as pixels see them. Rims of discs that stick out stand between pixels and points near
/// them: the light of one side of a rim is not that of the other.
class SeenPoints {
 public:
    /// `offset`: of the bake's coordinates in those of the tracer; `irradiance`: of the points, W/m^2. The
    /// references must outlive it.
    SeenPoints(const tracing::SurfelTracer& tracer, const PathsBake& bake, const glm::vec3& offset,
               std::span<const glm::vec3> irradiance);

    /// Returns those of the points about a place that it sees from `start` (start_of_rays()); all if they
    /// have about the same light and it sees the one with the largest share, which takes fewer rays. If it
    /// sees none, the nearest one of all that it sees, and all if there is none. `seen` holds the result
    /// unless it is `about`.
    std::span<const PointShare> about(const SurfacePoint& place, const glm::vec3& start,
                                      std::span<const PointShare> about, std::vector<PointShare>& seen) const;

 private:
    bool disagree(std::span<const PointShare> about) const;
    bool sees(const glm::vec3& start, const GatheringPoint& point) const;
    void find_nearest(const SurfacePoint& place, const glm::vec3& start, std::vector<PointShare>& seen) const;

    /// What squared_error_of() reads of a point, side by side: places that see none of their points ask for
    /// the errors of thousands.
    struct Facing {
        glm::vec3 position{0.0f};
        float per_reach2 = 0;  ///< 1 / m^2
        glm::vec3 normal{0.0f};
        float unused = 0;
    };
    const tracing::SurfelTracer& tracer_;
    const PathsBake& bake_;
    glm::vec3 offset_;
    std::span<const glm::vec3> irradiance_;
    std::vector<Facing> facing_;  ///< of each point
};

}  // namespace lucarne::gi::paths
