// Lights, skies and materials for tests.
#pragma once

#include <cmath>
#include <memory>

#include <glm/geometric.hpp>

#include "gi/scene/environment.h"
#include "gi/shared/light.h"
#include "gi/shared/material.h"

namespace lucarne::gi::scenes {

/// Returns a material that reflects the shares `diffuse` and `specular`, whose lobe has the exponent
/// `exponent`, and emits the radiance `emission`.
inline Material material(float diffuse = 1, float specular = 0, float exponent = 1, float emission = 0) {
    return {glm::vec4(diffuse, diffuse, diffuse, specular),
            glm::vec4(emission, emission, emission, exponent)};
}

inline Light point(const glm::vec3& position, float intensity) {
    Light light{};
    light.kind = kPointLight;
    light.position = glm::vec4(position, 0);
    light.strength = glm::vec4(glm::vec3(intensity), 0);
    return light;
}
/// Returns a spot light that is as bright as `intensity` up to `inner_angle` from its axis and ends at
/// `half_angle`.
inline Light spot(const glm::vec3& position, const glm::vec3& target, float half_angle, float inner_angle,
                  float intensity) {
    return {glm::vec4(position, std::cos(half_angle)),
            glm::vec4(glm::normalize(target - position), std::cos(inner_angle)),
            glm::vec4(intensity, intensity, intensity, 0)};
}

inline Light rectangle_light(const glm::vec3& middle, const glm::vec3& half_edge, float other_half,
                             const glm::vec3& normal, float radiance) {
    Light light{};
    light.kind = kRectangleLight;
    light.position = glm::vec4(middle, 0);
    light.direction = glm::vec4(normal, 0);
    light.extent = glm::vec4(half_edge, other_half);
    light.strength = glm::vec4(glm::vec3(radiance), 0);
    return light;
}
inline Light disc_light(const glm::vec3& middle, float radius, const glm::vec3& normal, float radiance) {
    Light light = rectangle_light(middle, glm::vec3(0), radius, normal, radiance);
    light.kind = kDiscLight;
    return light;
}
inline Light wide_sun(const glm::vec3& direction, float angular_radius, float irradiance) {
    Light light{};
    light.kind = kDirectionalLight;
    light.direction = glm::vec4(glm::normalize(direction), angular_radius);
    light.strength = glm::vec4(glm::vec3(irradiance), 0);
    return light;
}
inline std::shared_ptr<const Environment> even_sky(float radiance) {
    auto sky = std::make_shared<Environment>();
    sky->texels = {glm::vec3(radiance)};
    return sky;
}

}  // namespace lucarne::gi::scenes
