#include "gi/gbuffer/light_view.h"

#include <cmath>

#include <glm/geometric.hpp>

#include "gi/gbuffer/gbuffer.h"

namespace lucarne::gi {
namespace {

// Diameters of the scene from its middle to the pinhole of a directional light. Rays part by 1/500 at most, a
// texel of 512 over the whole diameter, and a float's step at that distance is a hundredth of such a texel.
constexpr float kFarAway = 250.0f;
// Texels beyond each edge of a cube's face, for look-ups beside it.
constexpr float kBorder = 4.0f;

CameraView square_view(const glm::vec3& origin, const glm::vec3& forward, float tangent, float near,
                       uint32_t resolution) {
    const glm::vec3 helper = std::abs(forward.z) < 0.9f ? glm::vec3(0, 0, 1) : glm::vec3(0, 1, 0);
    const glm::vec3 right = glm::normalize(glm::cross(forward, helper)), up = glm::cross(right, forward);
    return {glm::vec4(origin, near),
            glm::vec4(forward, 0),
            glm::vec4(right * tangent, 0),
            glm::vec4(up * tangent, 0),
            resolution,
            resolution,
            0,
            0};
}

CameraView directional_view(const Light& light, const Bounds& bounds, uint32_t resolution) {
    const glm::vec3 direction(light.direction.x, light.direction.y, light.direction.z);
    const float radius = std::max(glm::length(bounds.max - bounds.min) / 2, 1e-3f);
    const float distance = 2 * kFarAway * radius;
    return square_view((bounds.min + bounds.max) / 2.0f - direction * distance, direction,
                       radius / (distance - radius), distance - 2 * radius, resolution);
}

CameraView face_view(const Light& light, uint32_t face, uint32_t resolution) {
    glm::vec3 forward(0.0f);
    forward[static_cast<int>(face / 2)] = face % 2 ? -1.0f : 1.0f;
    const auto texels = static_cast<float>(resolution);
    const float tangent = texels / std::max(texels - 2 * kBorder, 1.0f);
    return square_view(glm::vec3(light.position.x, light.position.y, light.position.z), forward, tangent,
                       1e-3f, resolution);
}

}  // namespace

std::vector<LightView> light_views(const Frame& frame) {
    std::vector<LightView> views;
    const uint32_t resolution = frame.settings.light_resolution;
    for (size_t i = 0; i < frame.lights.size(); ++i) {
        const Light& light = frame.lights[i];
        if (light.kind == kSpotLight) views.push_back({i, 0, spot_view(light, resolution)});
        if (light.kind == kDirectionalLight)
            views.push_back({i, 0, directional_view(light, frame.bounds, resolution)});
        for (uint32_t face = 0; light.kind == kPointLight && face < 6; ++face)
            views.push_back({i, face, face_view(light, face, resolution)});
    }
    return views;
}

}  // namespace lucarne::gi
