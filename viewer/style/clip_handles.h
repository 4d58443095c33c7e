#pragma once

#include <array>
#include <optional>
#include <vector>

#include <glm/vec3.hpp>

#include "gi/scene/clip.h"

namespace lucarne::viewer {

/// A handle that can be dragged: the centre of a box's face or a plane's position moves along an axis; a
/// corner of a box turns the box about the vertical.
struct ClipHandle {
    bool plane = false;
    size_t index = 0;  ///< of the box or plane
    int face = 0;      ///< of a box: 0 to 5 for -x, +x, -y, +y, -z, +z of its own axes, or kCorner
    static constexpr int kCorner = 6;
    bool operator==(const ClipHandle&) const = default;
};
struct HandlePlace {
    glm::dvec3 position{0.0}, axis{0.0};  ///< world position; unit axis, outward (a corner's axis is upward)
};

std::vector<ClipHandle> clip_handles(const gi::Clip& clip);
/// Returns the place of a handle, which must be one of the clip's.
HandlePlace handle_place(const gi::Clip& clip, const ClipHandle& handle);
/// Moves a face or plane (no corner) along its axis by world units. A box keeps at least a thousandth of its
/// length.
void move_handle(gi::Clip& clip, const ClipHandle& handle, double by);
/// Returns a box's rotation after its corner's handle is dragged to the point where a ray from `eye` meets
/// the corner's height. Returns nothing if the ray does not meet it.
std::optional<double> turned_to(const gi::ClipBox& box, const glm::dvec3& eye, const glm::dvec3& ray);
/// Returns the corners in world coordinates. Corner i is at the upper end of axis j if bit j of i is set.
std::array<glm::dvec3, 8> box_corners(const gi::ClipBox& box);

/// Returns the position along an axis from `origin` that is nearest to the ray from `eye`. Returns nothing if
/// axis and ray are nearly parallel.
std::optional<double> along_axis(const glm::dvec3& origin, const glm::dvec3& axis, const glm::dvec3& eye,
                                 const glm::dvec3& ray);

}  // namespace lucarne::viewer
