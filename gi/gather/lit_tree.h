#pragma once

#include <span>
#include <vector>

#include "gi/gather/gatherer.h"
#include "gi/gl_frame.h"
#include "gi/lighting/light_gbuffers.h"
#include "gi/tree/surfel_tree.h"

namespace lucarne::gi {

/// The surfels of a light cut, a tree over them, and the light that they send out before any bounce.
class LitTree {
 public:
    /// Takes the surfels of frame.gl.cuts.light and builds their tree. Drops the light. Errors: device
    /// memory, a shader that fails.
    Result<void> set_surfels(Frame& frame);
    /// Computes what the surfels emit, and what they reflect of these views of the lights. Errors likewise.
    /// Specular reflection is not in own_light() but in lobes().
    Result<void> set_light(Frame& frame, const std::vector<LightView>& views, LightGBuffers& gbuffers);

    const SurfelTree& tree() const { return tree_; }
    std::span<const FlatSurfel> surfels() const { return surfels_; }
    /// Of each surfel: its radiance on both sides, W/(sr m^2).
    std::span<const SideLight> own_light() const { return own_; }
    /// Of each slot of the tree: what its surfels reflect of the lights by their specular lobes.
    const SlotLobes& lobes() const { return lobes_; }
    /// Of each surfel: the radiance that it sends out for each unit of irradiance, 1/sr; specular reflection
    /// is spread evenly.
    std::span<const glm::vec3> reflectances() const { return reflectances_; }

 private:
    SurfelTree tree_;
    std::vector<FlatSurfel> surfels_;
    std::vector<SideLight> own_;
    std::vector<glm::vec3> reflectances_;
    SlotLobes lobes_;
    Buffer flat_, irradiance_, directions_;
};

}  // namespace lucarne::gi
