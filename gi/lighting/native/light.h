#pragma once

#include <cstdint>
#include <span>

#include <glm/vec4.hpp>

#include "gi/shared/camera.h"
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

/// Adds emission and background to the picture or, if `add` is false, replaces its content, as own_light.comp
/// does.
void add_own_light(const LitPicture& picture, const SkyPicture& sky, bool add);

/// Adds the light of a spot, point, cosine or directional light that diffuse surfaces reflect, as far as the
/// view shows it, as light.comp does. Lobes are left out.
void add_light(const LitPicture& picture, const Light& light, const LightShadows& shadows);

}  // namespace lucarne::gi::native
