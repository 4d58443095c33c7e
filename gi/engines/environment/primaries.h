#pragma once

#include <cstdint>
#include <span>
#include <vector>

#include <glm/vec3.hpp>

#include "gi/host_frame.h"
#include "gi/tree/surfel_tree.h"

namespace lucarne::gi::environment {

/// A side of a slot, as a place where light is gathered.
struct SidePlace {
    uint32_t side = 0;  ///< twice the slot, and one more for the back
    glm::vec3 position{0.0f}, normal{0.0f, 0.0f, 1.0f};
    float lift = 0;  ///< radius of the surfel at the position, m
    float size = 0;  ///< radius of what the place stands for, m
};

/// Returns a place in the middle of what a side stands for: its surfel that is nearest to the middle, with
/// the direction that most of its surfels share.
SidePlace place_of(const SurfelTree& tree, std::span<const FlatSurfel> surfels, uint32_t side);

/// Returns the primary visible points (Harada 2014, section 3.4): the largest nodes of one surface that are
/// no larger than `spacing` pixels, as far as the picture shows them. None is above another in the tree.
/// There are at most `most`; with more, larger nodes are taken.
std::vector<SidePlace> primary_places(const SurfelTree& tree, std::span<const FlatSurfel> surfels,
                                      const CameraView& camera, std::span<const SurfacePoint> visible,
                                      float spacing, size_t most);

}  // namespace lucarne::gi::environment
