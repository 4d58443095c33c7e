#pragma once

#include <optional>
#include <vector>

#include <glm/vec3.hpp>

#include "viewer/light/model.h"

namespace lucarne::viewer {

/// The sphere on which directional lights have their handles, in the direction that the light comes from.
/// Other lights have handles at their position and target.
struct LightSphere {
    glm::dvec3 centre{0.0};
    double radius = 1;  ///< world units
};

std::vector<LightHandle> light_handles(const std::vector<gi::SceneLight>& lights);
/// Returns the world position of one handle of a light.
glm::dvec3 handle_place(const gi::SceneLight& light, LightHandle::Part part, const LightSphere& sky);

/// Returns where a drag moves a handle: within the plane through the handle that faces `forward`, or on the
/// sphere for directional lights. Returns nothing if the ray from `eye` misses the plane or sphere.
std::optional<glm::dvec3> dragged_place(const gi::SceneLight& light, LightHandle::Part part,
                                        const LightSphere& sky, const glm::dvec3& eye, const glm::dvec3& ray,
                                        const glm::dvec3& forward);
/// Moves a handle of a light. Returns false and changes nothing if the light would have no direction. A
/// dragged sun loses its place and time.
bool move_light(gi::SceneLight& light, LightHandle::Part part, const glm::dvec3& to, const LightSphere& sky);

}  // namespace lucarne::viewer
