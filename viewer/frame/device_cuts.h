#pragma once

#include <cstdint>
#include <span>
#include <vector>

#include <glm/vec3.hpp>

#include "gi/gl_frame.h"
#include "gi/scene/scene.h"
#include "gi/surfels/surfel_pool.h"
#include "octree/tree/source.h"
#include "viewer/frame/cut_choice.h"

namespace lucarne::viewer {

/// What cuts on the device are built from.
struct CutInputs {
    gi::Device& device;
    const gi::SurfelPool& pool;
    const octree::NodeSource& source;
    std::span<const octree::Filling> fillings;
    const gi::Scene& scene;
    glm::dvec3 origin;  ///< local origin, world units
};

/// The resident parts of the chosen cuts on the device. The light's cuts can be held as they are while an
/// engine reads them over several frames, unless they are torn: nodes that they consist of are gone, or they
/// have another origin or clip.
class DeviceCuts {
 public:
    /// Other cuts were chosen, or nodes have arrived.
    void changed() { stale_ = light_stale_ = true; }
    /// Nothing of the cuts can stay.
    void tear() { stale_ = light_stale_ = torn_ = true; }
    /// A node was evicted or replaced.
    void node_gone(uint32_t node);

    /// Builds what has changed and what the engines need. `hold_light`: the light's cuts stay if they can,
    /// but for the views of lights that have changed. Returns whether anything was built. Errors: no device
    /// memory.
    Result<bool> build(const CutSet& chosen, const CutInputs& from, bool hold_light);

    const gi::DeviceCut& view() const { return view_; }
    /// The cuts of a frame, which stay valid until the next build().
    gi::FrameCuts of_frame() const;
    /// Points drawn by the views of all lights; of the light cut; drawn by all cuts, with those that are
    /// clipped as whole nodes.
    uint64_t light_view_points() const;
    uint64_t light_points() const { return light_.surfels(); }
    uint64_t ready_points() const;

 private:
    bool intact(const CutSet& chosen, const gi::Scene& scene) const;

    gi::DeviceCut view_, light_;
    std::vector<gi::DeviceCut> light_views_;
    gi::EngineNeeds needs_;               ///< for which all were chosen
    std::vector<gi::SceneLight> lights_;  ///< for which light_views_ were chosen
    bool stale_ = true, light_stale_ = true, torn_ = true;
};

}  // namespace lucarne::viewer
