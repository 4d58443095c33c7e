#pragma once

#include <cstddef>
#include <cstdint>
#include <memory>
#include <span>
#include <vector>

#include <glm/vec3.hpp>

#include "gi/device/gl/device.h"
#include "gi/engines/paths/bake.h"
#include "gi/lighting/light_gbuffers.h"
#include "gi/tracing/surfel_tracer.h"

namespace lucarne::gi::paths {

/// The light of lamps that arrives at entry points.
struct LampLight {
    std::vector<glm::vec3> irradiance;  ///< W/m^2
    /// Unit directions to the lamps, their mean by irradiance. Empty: nobody asked.
    /// Zero where surfaces have no lobe.
    std::vector<glm::vec3> directions;
};

/// The light of lamps at entry points, by the lamps' shadow maps or by rays: E and V of Yue et al. 2007, eq.
/// 8 and 9. Of few lamps each is computed by itself and kept, so a moved lamp repeats its own light only.
class EntryLight {
 public:
    /// Sends entry points to the device unless it has them. `bake`: the one whose entry points they are.
    /// Errors: device memory.
    Result<void> set_entries(Frame& frame, const std::shared_ptr<const PathsBake>& bake);
    /// Returns the light of each entry point by all these views of lights: shadows by rays of `tracer`, or by
    /// maps if it is null. `any_state`: shadow maps of an earlier state of their cuts will do.
    /// `materials`: of surfels, if the directions at those with lobes are wanted; else empty. Errors: device
    /// memory, a shader that fails.
    Result<LampLight> light(Frame& frame, std::span<const LightView> views, LightGBuffers& gbuffers,
                            bool any_state, const tracing::SurfelTracer* tracer,
                            std::span<const Material> materials);
    /// How many lamps the last call computed; the others had not changed.
    size_t computed() const { return computed_; }

 private:
    /// What a lamp sends to the entry points.
    struct Kept {
        Light light;
        uint64_t cut = 0;        ///< DeviceCut::fingerprint() of what may hide the lamp
        bool is_traced = false;  ///< shadows by rays, not by maps
        std::vector<glm::vec3> irradiance;
    };
    Result<std::vector<glm::vec3>> compute(Frame& frame, std::span<const LightView> views,
                                           LightGBuffers& gbuffers, bool any_state);

    void add_directions(const Frame& frame, std::span<const LightView> views,
                        std::span<const Material> materials, std::span<const glm::vec3> irradiance,
                        std::span<glm::vec3> sum) const;
    void trace(Frame& frame, const LightView& view, const tracing::SurfelTracer& tracer,
               std::span<glm::vec3> irradiance) const;

    std::shared_ptr<const PathsBake> bake_;  ///< whose entry points are on the device
    glm::vec3 offset_{0.0f};
    Buffer flat_, irradiance_;
    std::vector<Kept> kept_;
    size_t computed_ = 0;
};

}  // namespace lucarne::gi::paths
