#pragma once

#include <cstdint>
#include <memory>
#include <span>
#include <vector>

#include <glm/vec3.hpp>

#include "gi/frame.h"
#include "gi/host_frame.h"
#include "gi/lighting/sky_directions.h"
#include "gi/shared/brdf.h"
#include "gi/shared/light.h"
#include "gi/tracing/surfel_tracer.h"
#include "io/core/error.h"

namespace lucarne::gi {

/// The lights of a scene with shadows by rays: each point asks for itself what it sees of each light. So
/// shadows have no texels, and lights with a size shine softly in one frame.
class TracedLights {
 public:
    /// `sky` shines as well. About `samples` rays from each point are shared out among the lights with a size
    /// and the sky, at least one each. `tracer` and `sky` must outlive this.
    TracedLights(const tracing::SurfelTracer& tracer, std::span<const Light> lights, const SkyDirections& sky,
                 uint32_t samples);

    /// What points see of a light with a size. Bits: what their rays met.
    enum Sight : uint8_t { kNoSight = 0, kSeen = 1, kHidden = 2, kSeenInPart = kSeen | kHidden };

    /// Number of lights with a size that are probed with few rays first; 0 if that would cost more than it
    /// saves.
    size_t probed() const;
    /// Casts few rays to each of these lights, and adds what they met to `sights`, which must be kNoSight: it
    /// stays so where no ray is above the surface.
    void probe(const SurfacePoint& point, uint64_t key, std::span<uint8_t> sights) const;
    /// Returns what a point reflects of the lights to its viewer, W/(sr m^2). `key` chooses the samples.
    /// `sights`: of each light what the points about this one see of it. Where that is one and the same, no
    /// more rays are cast to it. Empty: nothing is known.
    glm::vec3 reflected(const SurfacePoint& point, const Reflectance& surface, uint64_t key,
                        std::span<const uint8_t> sights) const;

 private:
    class Rays;

    const tracing::SurfelTracer& tracer_;
    std::vector<Light> sharp_, soft_;
    const SkyDirections& sky_;
    uint32_t samples_ = 1;  ///< of each light with a size
};

/// Rays against the surfels of an engine's light cut, kept as long as the cut stays.
class LightCutTracer {
 public:
    /// Brings it up to date. `revision`: of the cut (LightCutRevisions::light). Errors: Embree's.
    Result<void> update(Frame& frame, uint64_t revision);
    /// Null: it was never brought up to date.
    const tracing::SurfelTracer* get() const { return tracer_.get(); }
    const tracing::SurfelTracer& operator*() const { return *tracer_; }

 private:
    std::unique_ptr<tracing::SurfelTracer> tracer_;
    uint64_t revision_ = 0;
};

/// Whether the frame asks for shadows by rays: while anything moves, maps are faster, which stay.
bool traces_shadows(const Frame& frame);

/// Adds the first reflection of the frame's lights and of `sky` to the picture, with shadows by rays. Leaves
/// the picture as it is if the frame is given up. Waits for the device.
void add_traced_light(Frame& frame, const tracing::SurfelTracer& tracer, const SkyDirections& sky);

}  // namespace lucarne::gi
