#pragma once

#include <cstdint>
#include <span>

#include <glm/geometric.hpp>
#include <glm/vec3.hpp>
#include <glm/vec4.hpp>

#include "gi/shared/camera.h"
#include "gi/shared/flat_surfel.h"
#include "gi/shared/gbuffer.h"
#include "gi/shared/light.h"
#include "gi/shared/material.h"

namespace lucarne::gi::native {

/// A picture that is lit: its G-buffer and its radiance, W/(sr m^2), one element a pixel.
struct LitPicture {
    const CameraView& camera;
    const GBufferTexel* texels;
    std::span<const Material> materials;  ///< LUCARNE_DEVICE_MATERIALS
    glm::vec4* radiance;
};

/// The background, r, g, b of each texel: the picture of an environment turned by `rotation` radians, or one
/// colour, a single texel.
struct SkyPicture {
    const float* texels;
    uint32_t width, height;
    float rotation;
};

/// A view from a light (gi/lighting/light_view.h) and its G-buffer, the shadow map.
struct LightShadows {
    const CameraView& view;
    const GBufferTexel* texels;
    uint32_t face;  ///< of the light, which the view shows
};

/// What look-ups of points relative to `origin` need of the shadow map.
struct ShadowLook {
    const LightShadows& seen;
    glm::vec3 from_view;  ///< from the origin of the light's view to that of the points, m
    float texel_width;    ///< of the light's view at a depth of 1, m

    ShadowLook(const LightShadows& shadows, const glm::vec3& origin)
        : seen(shadows),
          from_view(origin - glm::vec3(shadows.view.origin)),
          texel_width(2 * glm::length(glm::vec3(shadows.view.right)) /
                      static_cast<float>(shadows.view.width)) {}
};

/// Surfels that are lit. Six numbers a surfel: r, g, b of its front, then of its back.
struct LitSides {
    std::span<const FlatSurfel> surfels;
    float* irradiance;  ///< W/m^2
    float* directions;  ///< may be null: unit vectors to the light times the mean irradiance
};

/// Adds emission and background to the picture or, if `add` is false, replaces its content, as own_light.comp
/// does.
void add_own_light(const LitPicture& picture, const SkyPicture& sky, bool add);

/// Adds the light of a spot, point, cosine or directional light that diffuse surfaces reflect, as far as the
/// view shows it, as light.comp does. Lobes are left out.
void add_light(const LitPicture& picture, const Light& light, const LightShadows& shadows);

/// Adds the irradiance of surfels by such a light, as surfel_light.comp does.
void add_surfel_light(const LitSides& lit, const Light& light, const LightShadows& shadows);

}  // namespace lucarne::gi::native
