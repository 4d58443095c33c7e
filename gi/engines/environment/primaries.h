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
    glm::vec3 viewer{0.0f};  ///< unit, to the viewer whose picture shows the position; zero: none
    float radius = 0;        ///< of the surfel at the position, m
    float size = 0;          ///< radius of what the place stands for, m
};

/// Returns a place in the middle of what a side stands for: its surfel that is nearest to the middle. The
/// normal is the direction that most of the surfels share if they are one surface, else that of the surfel.
SidePlace place_of(const SurfelTree& tree, std::span<const FlatSurfel> surfels, uint32_t side);

/// Whether what a slot stands for is no larger in the picture of a camera than the distance of points that
/// are so many pixels apart. What lies beside the picture counts likewise, by its distance.
/// `least`: the slot counts as if its bound had at least this radius.
bool is_fine(const SurfelTree& tree, size_t slot, const CameraView& camera, float spacing, float least = 0);

/// Returns the primary visible points (Harada 2014, section 3.4): those nodes of one surface that are just no
/// larger than `spacing` pixels, as far as the picture shows them, without those for which another is near
/// enough to stand for them. There are at most `most`; with more, larger nodes are taken.
std::vector<SidePlace> primary_places(const SurfelTree& tree, std::span<const FlatSurfel> surfels,
                                      const CameraView& camera, std::span<const SurfacePoint> visible,
                                      float spacing, size_t most);

}  // namespace lucarne::gi::environment
