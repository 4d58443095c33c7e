#pragma once

#include <optional>
#include <vector>

#include <glm/vec3.hpp>

#include "viewer/light/tools.h"

namespace lucarne::viewer {

/// Where handles stand: a light's position, what it shines at, and for directional lights a place on a sphere
/// about `centre` where they come from.
struct LightSphere {
    glm::dvec3 centre{0.0};
    double radius = 1;  ///< world units
};

std::vector<LightHandle> light_handles(const std::vector<gi::SceneLight>& lights);
/// `handle` is one of the lights'.
glm::dvec3 handle_place(const gi::SceneLight& light, LightHandle::Part part, const LightSphere& sky);

/// Where a drag leads: along the plane through the handle that faces `forward`; on the sphere for what comes
/// from the sky. None where the ray from `eye` misses that.
std::optional<glm::dvec3> dragged_place(const gi::SceneLight& light, LightHandle::Part part,
                                        const LightSphere& sky, const glm::dvec3& eye, const glm::dvec3& ray,
                                        const glm::dvec3& forward);
/// A light that would shine nowhere stays as it is. A sun that is dragged forgets its place and time.
bool move_light(gi::SceneLight& light, LightHandle::Part part, const glm::dvec3& to, const LightSphere& sky);

}  // namespace lucarne::viewer
