// Lights that have a size, for tests.
#pragma once

#include <memory>

#include <glm/geometric.hpp>

#include "gi/scene/environment.h"
#include "gi/shared/light.h"

namespace lucarne::gi::scenes {

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
