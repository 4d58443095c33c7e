#include "gi/lighting/light_view.h"

#include <cmath>

#include <glm/geometric.hpp>

#include "gi/gl_frame.h"
#include "gi/lighting/light_options.h"
#include "gi/lighting/nested_views.h"
#include "gi/raster/gbuffer.h"

namespace lucarne::gi {
namespace {

// Distance of the pinhole of a directional light from the middle of the scene, in diameters of the scene.
// Rays diverge by 1/500 at most, which is a texel of 512 over the whole diameter, and a float's step at that
// distance is a hundredth of such a texel.
constexpr float kFarAway = 250.0f;
// Texels beyond each edge of a cube's face, for shadow look-ups at the edge.
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

/// Makes the view of a directional light: as many texels as a square of `resolution` has, nearly square ones
/// unless the scene is very elongated.
CameraView directional_view(const Light& light, const Bounds& bounds, uint32_t resolution) {
    const glm::vec3 direction(light.direction.x, light.direction.y, light.direction.z);
    const float radius = std::max(glm::length(bounds.max - bounds.min) / 2, 1e-3f);
    const float distance = 2 * kFarAway * radius;
    const Outline seen = outline_along(bounds, direction);
    const float stretch = std::clamp(std::sqrt(seen.half.x / seen.half.y), .5f, 2.0f);
    const auto texels = [&](float share) {
        return std::max(static_cast<uint32_t>(static_cast<float>(resolution) * share), 1u);
    };
    return {glm::vec4((bounds.min + bounds.max) / 2.0f - direction * distance, distance - 2 * radius),
            glm::vec4(direction, 0),
            glm::vec4(seen.right * (seen.half.x / (distance - radius)), 0),
            glm::vec4(seen.up * (seen.half.y / (distance - radius)), 0),
            texels(stretch),
            texels(1 / stretch),
            0,
            0};
}

CameraView face_view(const Light& light, uint32_t face, uint32_t resolution) {
    glm::vec3 forward(0.0f);
    forward[static_cast<int>(face / 2)] = face % 2 ? -1.0f : 1.0f;
    const auto texels = static_cast<float>(resolution);
    const float tangent = texels / std::max(texels - 2 * kBorder, 1.0f);
    return square_view(glm::vec3(light.position.x, light.position.y, light.position.z), forward, tangent,
                       1e-3f, resolution);
}

/// Makes the view of a quarter of the half space in front of a cosine light, between its normal, its side
/// and the third axis. Seen along the middle, 45 degrees up, the quarter extends 1 up and down and sqrt 2 to
/// both sides.
CameraView quarter_view(const Light& light, uint32_t face, uint32_t resolution) {
    const glm::vec3 normal(light.direction.x, light.direction.y, light.direction.z);
    const glm::vec3 side(light.extent.x, light.extent.y, light.extent.z);
    const glm::vec3 other = glm::cross(normal, side);
    const glm::vec3 level = glm::normalize((face & 1 ? -side : side) + (face & 2 ? -other : other));
    const glm::vec3 forward = glm::normalize(normal + level), up = glm::normalize(normal - level);
    const auto height = std::max(static_cast<uint32_t>(static_cast<float>(resolution) / std::sqrt(2.0f)), 1u);
    const auto texels = static_cast<float>(height);
    const float tangent = texels / std::max(texels - 2 * kBorder, 1.0f);
    return {glm::vec4(light.position.x, light.position.y, light.position.z, 1e-3f),
            glm::vec4(forward, 0),
            glm::vec4(glm::cross(forward, up) * (std::sqrt(2.0f) * tangent), 0),
            glm::vec4(up * tangent, 0),
            resolution,
            height,
            0,
            0};
}

/// Makes one of the nested views of a directional light that do not show everything. Its rays diverge as
/// those of the whole view do, or less, and it is so far away that even there where the scan ends toward the
/// light it is as wide as nested_view() asks.
CameraView finer_view(const Light& light, uint32_t face, const Bounds& bounds, uint32_t resolution) {
    const glm::vec3 direction(light.direction), middle(light.position);
    const float half =
        light.position.w * std::pow(kNestedStep, static_cast<float>(face)) * (1 + kNestedBorder);
    const float reach =
        glm::length(bounds.max - bounds.min) / 2 + glm::length((bounds.min + bounds.max) / 2.0f - middle);
    const float distance = std::max(2 * kFarAway * half, (1 + 1 / kNestedBorder) * reach);
    return square_view(middle - direction * distance, direction, half / distance, distance - reach,
                       resolution);
}

CameraView view_of(const Light& light, uint32_t face, const Frame& frame, uint32_t resolution) {
    switch (light.kind) {
        case kDirectionalLight:
            return face + 1 < light.nested ? finer_view(light, face, frame.bounds, resolution)
                                           : directional_view(light, frame.bounds, resolution);
        case kPointLight:
            return face_view(light, face, resolution);
        case kCosineLight:
            return quarter_view(light, face, resolution);
        default:
            return spot_view(light, resolution);
    }
}

}  // namespace

Outline outline_along(const Bounds& bounds, const glm::vec3& direction) {
    constexpr int kTurns = 16;  // of a right angle
    const glm::vec3 helper = std::abs(direction.z) < 0.9f ? glm::vec3(0, 0, 1) : glm::vec3(0, 1, 0);
    const glm::vec3 level = glm::normalize(glm::cross(direction, helper));
    const glm::vec3 upright = glm::cross(level, direction), half = (bounds.max - bounds.min) / 2.0f;
    Outline best;
    for (int turn = 0; turn < kTurns; ++turn) {
        const float angle = 1.57079633f * static_cast<float>(turn) / kTurns;
        Outline tried{level * std::cos(angle) + upright * std::sin(angle),
                      upright * std::cos(angle) - level * std::sin(angle),
                      {}};
        const auto reach = [&](const glm::vec3& axis) {
            return std::max(glm::dot(glm::abs(axis), half), 1e-3f);
        };
        tried.half = {reach(tried.right), reach(tried.up)};
        if (turn == 0 || tried.half.x * tried.half.y < best.half.x * best.half.y) best = tried;
    }
    return best;
}

std::vector<LightView> light_views(const Frame& frame, const SkyDirections& sky, uint64_t index) {
    std::vector<LightView> views;
    const uint32_t side = frame.settings[kLightResolution];
    for (const auto& [light, cut, of_sky] : sharp_lights(frame, sky, index)) {
        // Many such samples make a light with a size, whose shadows are soft, so half the resolution is
        // enough.
        const uint32_t resolution = light.kind == kCosineLight ? std::max(side / 2, 1u) : side;
        for (uint32_t face = 0; face < light_faces(light); ++face) {
            // The light's own cut has the detail that its widest view shows.
            const DeviceCut* drawn = face + 1 < light.nested ? frame.gl.cuts.light : cut;
            views.push_back({light, drawn, face, view_of(light, face, frame, resolution), of_sky});
        }
    }
    return views;
}

}  // namespace lucarne::gi
