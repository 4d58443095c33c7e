#pragma once

#include <atomic>
#include <cstdint>
#include <functional>
#include <span>
#include <vector>

#include <glm/vec3.hpp>
#include <glm/vec4.hpp>

#include "gi/gather/gather_point.h"
#include "gi/gather/gather_sky.h"
#include "gi/tracing/surfel_tracer.h"

namespace lucarne::gi {

/// Where a room is open to the sky: windows and doors that few rays of a micro-buffer find by chance. They
/// are covered by spheres, at which points cast rays of their own. Rays of both kinds count by their
/// densities (balance heuristic, Veach & Guibas 1995, "Optimally combining sampling techniques for Monte
/// Carlo rendering"), so the mean is that of the whole sky, wherever the spheres are.
class SkyOpenings {
 public:
    /// Finds the openings that are seen from some points (`pilots`). Finds none if more than kWide of the sky
    /// is seen, where buffers do, or none of it, or if `stop` becomes true. The same arguments give the same
    /// openings. `tracer` and `sky` must outlive the result.
    static SkyOpenings find(const tracing::SurfelTracer& tracer, const GatherSky& sky,
                            std::span<const GatherPoint> pilots, uint64_t seed,
                            const std::atomic<bool>* stop = nullptr);

    /// Replaces the sky, which must outlive this: the openings stay where they are. A sky without light is
    /// one to find() nothing under, and must not come here.
    void set_sky(const GatherSky& sky);

    bool empty() const { return spheres_.empty(); }
    /// The middles and radii of the spheres, m.
    std::span<const glm::vec4> spheres() const { return spheres_; }

    /// Sets with what density a point casts rays into the cone of each sphere, over the density of its
    /// micro-buffer's rays toward the normal; the latter are 1 / `rays` times as many. 0: none, as at spheres
    /// that are too near.
    void find_densities(const GatherPoint& point, float rays, std::span<float> densities) const;
    /// Casts `count` rays and calls visit(direction, light) for each that meets the sky. `light`: what it
    /// adds to the mean radiance of the point, weighted by the cosine, W/(sr m^2). `densities`: by
    /// find_densities() with the same `rays`.
    void each_ray(const GatherPoint& point, std::span<const float> densities, float rays, uint32_t count,
                  const std::function<void(const glm::vec3&, const glm::vec3&)>& visit) const;

    /// The largest mean share of the half spaces of pilots that is open.
    static constexpr double kWide = 0.15;
    static constexpr size_t kPilots = 512;  ///< that find the openings of a picture
    static constexpr uint32_t kRays = 32;   ///< of each point, into the cones of the spheres

 private:
    /// Sets the shares of the spheres that the pilots see.
    void find_visible(std::span<const GatherPoint> pilots, std::span<const glm::vec3> starts, uint64_t seed,
                      const std::atomic<bool>* stop);
    /// Adds what the pilots about a point see of each sphere to `visible`.
    void add_visible(const GatherPoint& point, std::span<float> visible) const;

    struct Pilot {
        glm::vec3 position, normal;
    };
    const tracing::SurfelTracer* tracer_ = nullptr;
    const GatherSky* sky_ = nullptr;
    std::vector<glm::vec4> spheres_;
    std::vector<glm::vec3> rays_;    ///< directions of those that found the spheres, sphere by sphere
    std::vector<size_t> first_ray_;  ///< of each sphere, and the end
    std::vector<float> brightness_;  ///< of the sky in each sphere, W/(sr m^2); 0: it gets no rays
    std::vector<Pilot> pilots_;
    std::vector<float> visible_;  ///< for each pilot: the open share of each sphere
};

}  // namespace lucarne::gi
