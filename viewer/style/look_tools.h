#pragma once

#include <array>
#include <optional>
#include <string>
#include <vector>

#include <glm/vec3.hpp>

#include "gi/scene/clip.h"

namespace lucarne::viewer {

/// A place that can be dragged: along an axis the middle of a box's face, or a plane's position; about the
/// vertical one of its corners.
struct ClipHandle {
    bool plane = false;
    size_t index = 0;  ///< of the box or plane
    int face = 0;      ///< of a box: 0 to 5 for -x, +x, -y, +y, -z, +z of its own axes; kCorner
    static constexpr int kCorner = 6;
    bool operator==(const ClipHandle&) const = default;
};
struct HandlePlace {
    glm::dvec3 position{0.0}, axis{0.0};  ///< world; unit, outward, of a corner upward
};

/// What the window keeps for the looks of points beside the scene's look itself.
struct LookTools {
    std::string lit_engine;  ///< what switching light on again goes back to; empty: the default
    std::optional<ClipHandle> held;
    bool show_handles = true;
};

std::vector<ClipHandle> clip_handles(const gi::Clip& clip);
/// `handle` is one of the clip's.
HandlePlace handle_place(const gi::Clip& clip, const ClipHandle& handle);
/// Moves the face or the plane, no corner, by world units along its axis; a box keeps a thousandth of its
/// length.
void move_handle(gi::Clip& clip, const ClipHandle& handle, double by);
/// A box's rotation once its corner's handle is turned to where a ray from `eye` meets the corner's height;
/// none where it does not.
std::optional<double> turned_to(const gi::ClipBox& box, const glm::dvec3& eye, const glm::dvec3& ray);
/// World; corner i is at the upper end of axis j where bit j of i is set.
std::array<glm::dvec3, 8> box_corners(const gi::ClipBox& box);

/// How far along an axis from `origin` lies what is nearest to the ray from `eye`; none where they run
/// alongside.
std::optional<double> along_axis(const glm::dvec3& origin, const glm::dvec3& axis, const glm::dvec3& eye,
                                 const glm::dvec3& ray);

}  // namespace lucarne::viewer
