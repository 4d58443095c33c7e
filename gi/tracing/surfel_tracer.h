#pragma once

#include <cstdint>
#include <functional>
#include <memory>
#include <optional>
#include <vector>

#include <glm/vec3.hpp>

#include "gi/shared/surfel.h"
#include "io/core/error.h"

namespace lucarne::gi::tracing {

/// A ray starts this many radii above its surfel, along the normal. gi/engines/reference/README.md explains
/// the choice: it weighs the light lost in corners against the wrong shadows that noise in the positions
/// would cause.
inline constexpr float kOriginOffset = 1.0f;

/// Returns whether rays can hit a surfel: it has a normal, a positive radius, and a finite place.
bool has_disc(const Surfel& surfel);

/// Ray queries against surfels as opaque discs with two equal sides (Embree's oriented discs), which end at
/// their lines (gi/shared/edge.h). Surfels
/// without a normal or with a radius that is not positive have no disc and are left out. Thread-safe once
/// made.
class SurfelTracer {
 public:
    /// Errors: Embree's (out of memory).
    static Result<std::unique_ptr<SurfelTracer>> create(std::vector<Surfel> surfels);
    ~SurfelTracer();
    SurfelTracer(const SurfelTracer&) = delete;
    SurfelTracer& operator=(const SurfelTracer&) = delete;

    /// The surfels that can be hit.
    const std::vector<Surfel>& surfels() const { return surfels_; }

    /// What a ray meets first.
    struct Hit {
        uint32_t surfel = 0;  ///< index into surfels()
        float distance = 0;   ///< m
        bool back = false;    ///< on the side from which its normal points away
    };
    /// Returns the first hit of a ray (`direction` is a unit vector) without reading its surfel, which is
    /// seldom in a cache.
    std::optional<Hit> first_hit(const glm::vec3& origin, const glm::vec3& direction) const;
    /// Returns the nearest surfel along a ray, as an index into surfels().
    std::optional<uint32_t> nearest(const glm::vec3& origin, const glm::vec3& direction) const;
    /// Returns whether a surfel blocks the segment, its ends excluded.
    bool occluded(const glm::vec3& from, const glm::vec3& to) const;
    /// Returns whether a surfel blocks the whole ray.
    bool occluded_along(const glm::vec3& origin, const glm::vec3& direction) const;

    /// Calls visit(index) once for every surfel on the ray from `begin` to `end`, m. The order is
    /// unspecified, but the same on every run.
    void each_crossed(const glm::vec3& origin, const glm::vec3& direction, float begin, float end,
                      const std::function<void(uint32_t)>& visit) const;

    /// Returns the area of all discs over the area of the surface (the sum of the surfels' shares); 0 if
    /// that is unknown. Randomly placed surfels let a share exp(-coverage) of the rays through.
    double coverage() const;

 private:
    struct Embree;
    SurfelTracer();
    std::unique_ptr<Embree> embree_;
    std::vector<Surfel> surfels_;
};

/// Returns the origin of a ray from a surfel: above its disc, and far enough for the rounding of
/// coordinates. `normal` points to the side where the ray leaves.
glm::vec3 offset_origin(const glm::vec3& position, const glm::vec3& normal, float radius);

/// Returns the origin of rays from a point that a picture shows. `origin`: offset_origin() of the point;
/// `radius`: its surfel's. The G-buffer may show the rim of a disc that lies a little behind another surface
/// (kRimPush). Such rays have to start on the viewer's side of that surface; otherwise the rims of a sealed
/// room would be lit from outside. Where a noisy surface was scanned several times, it may show a disc
/// between discs of a layer above it (`normal`: of the point, toward the viewer), which would keep all light
/// from it.
glm::vec3 before_what_hides(const SurfelTracer& surfels, const glm::vec3& origin, const glm::vec3& viewer,
                            const glm::vec3& normal, float radius);

}  // namespace lucarne::gi::tracing
