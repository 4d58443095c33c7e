#pragma once

#include <cstdint>
#include <span>

#include "gi/engines/vpl/shading/native/interleaved.h"
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

/// Adds the irradiance by VPLs to every pixel, as shade.comp and shade_isolated.comp do where nothing is
/// glossy. Tiles are of n x n pixels.
void gather(const GatherInput& input, uint32_t n, const GatherOutput& output);

}  // namespace lucarne::gi::vpl::native
