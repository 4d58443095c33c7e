#include "viewer/light/handles.h"

#include <cmath>

#include <glm/geometric.hpp>

namespace lucarne::viewer {

using glm::dvec3;
using Part = LightHandle::Part;

std::vector<LightHandle> light_handles(const std::vector<gi::SceneLight>& lights) {
    std::vector<LightHandle> handles;
    for (size_t i = 0; i < lights.size(); ++i) {
        const bool sky = lights[i].kind == gi::LightKind::directional;
        handles.push_back({sky ? Part::sky : Part::position, i});
        if (!sky && lights[i].kind != gi::LightKind::point) handles.push_back({Part::target, i});
    }
    return handles;
}

dvec3 handle_place(const gi::SceneLight& light, Part part, const LightSphere& sky) {
    if (part == Part::position) return light.position;
    if (part == Part::target) return light.target;
    return sky.centre - glm::normalize(light.target - light.position) * sky.radius;
}

std::optional<dvec3> dragged_place(const gi::SceneLight& light, Part part, const LightSphere& sky,
                                   const dvec3& eye, const dvec3& ray, const dvec3& forward) {
    const dvec3 direction = glm::normalize(ray);
    if (part != Part::sky) {
        const double along = glm::dot(direction, forward);
        const double depth = glm::dot(handle_place(light, part, sky) - eye, forward);
        if (!(along > 1e-6) || !(depth > 0)) return std::nullopt;
        return eye + direction * (depth / along);
    }
    // Stay on the side of the sphere that the handle is on. If the ray passes beside the sphere, take its
    // rim.
    const dvec3 from = eye - sky.centre;
    const double closest = -glm::dot(from, direction);
    const dvec3 foot = from + direction * closest;
    const double inside = sky.radius * sky.radius - glm::dot(foot, foot);
    if (inside <= 0) return sky.centre + glm::normalize(foot) * sky.radius;
    const bool behind = glm::dot(handle_place(light, part, sky) - sky.centre, forward) > 0;
    return sky.centre + foot + direction * (behind ? std::sqrt(inside) : -std::sqrt(inside));
}

bool move_light(gi::SceneLight& light, Part part, const dvec3& to, const LightSphere& sky) {
    if (part == Part::sky) {
        if (to == sky.centre) return false;
        light.sun.reset();
        light.target = light.position + (sky.centre - to);
        return true;
    }
    const dvec3& fixed = part == Part::position ? light.target : light.position;
    if (light.kind != gi::LightKind::point && glm::distance(to, fixed) < 1e-9 * sky.radius) return false;
    if (light.kind == gi::LightKind::point) light.target = to - dvec3(0, 0, 1);
    (part == Part::position ? light.position : light.target) = to;
    return true;
}

}  // namespace lucarne::viewer
