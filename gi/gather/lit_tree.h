#pragma once

#include <memory>
#include <span>
#include <vector>

#include "gi/lighting/lit_surfels.h"
#include "gi/tree/surfel_tree.h"

namespace lucarne::gi {

/// The surfels of a light cut, a tree over them, and the light that they send out before any bounce.
class LitTree {
 public:
    /// Takes the surfels of frame.gl.cuts.light and builds their tree. Those of a scan that is being read
    /// have the normals of planes (Bare::of_planes): without, nothing would be in the way of light. Drops the
    /// light. Errors: device memory, a shader that fails.
    Result<void> set_surfels(Frame& frame);
    /// Computes what the surfels emit, and what they reflect of these views of the lights (LitSurfels).
    /// Errors likewise. Specular reflection is not in own_light() but in lobes().
    Result<void> set_light(Frame& frame, const std::vector<LightView>& views, LightGBuffers& gbuffers);

    const SurfelTree& tree() const { return *tree_; }
    /// The same, for who keeps it after the next set_surfels().
    std::shared_ptr<const SurfelTree> kept_tree() const { return tree_; }
    std::span<const FlatSurfel> surfels() const { return lit_.surfels(); }
    std::span<const SideLight> own_light() const { return lit_.own_light(); }
    /// Of each slot of the tree: what its surfels reflect of the lights by their specular lobes; empty if
    /// nothing is glossy.
    const SideLobes& lobes() const { return lobes_; }
    /// The same of each surfel.
    const SideLobes& lobes_of_surfels() const { return lit_.lobes(); }
    std::span<const glm::vec3> reflectances() const { return lit_.reflectances(); }

    /// Returns lobes by surfel (set_light() has to come first) as lobes by slot.
    SideLobes pulled(const SideLobes& by_surfel) const;

 private:
    std::shared_ptr<const SurfelTree> tree_ = std::make_shared<SurfelTree>();
    LitSurfels lit_;
    SideLobes lobes_;
};

}  // namespace lucarne::gi
