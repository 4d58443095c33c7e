#pragma once

#include <cstdint>
#include <span>

#include <glm/vec4.hpp>

#include "gi/engines/vpl/vpl_light.h"
#include "gi/shared/camera.h"
#include "gi/shared/gbuffer.h"

namespace lucarne::gi::vpl::native {

/// What shading reads, as the shaders do.
struct GatherInput {
    const CameraView& camera;
    const GBufferTexel* texels;
    std::span<const VplLight> lights;
    const uint32_t* atlas;
    uint32_t side;  ///< texels along a side of a shadow map
    float splat_angle;
};

/// Where the light goes, W/m^2: that of each pixel's interleaved tile, and what isolated pixels need besides.
struct GatherOutput {
    glm::vec4 *irradiance, *own_irradiance;
    std::span<const uint32_t> isolated;  ///< pixels, ascending
    const uint32_t* joints;              ///< join.h
};

/// Adds the irradiance by VPLs to every pixel, as shade.comp and shade_isolated.comp do where nothing is
/// glossy. Tiles are of n x n pixels.
void gather(const GatherInput& input, uint32_t n, const GatherOutput& output);

}  // namespace lucarne::gi::vpl::native
