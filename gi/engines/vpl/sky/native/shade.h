#pragma once

#include <cstdint>
#include <span>

#include "gi/engines/vpl/shading/native/interleaved.h"
#include "gi/engines/vpl/shading/sky_map.h"

namespace lucarne::gi::vpl::native {

/// What lighting a picture by the sky reads.
struct SkyShading {
    const CameraView& camera;
    const GBufferTexel* pixels;
    std::span<const SkyMap> maps;
    const uint32_t* texels;  ///< of all maps
    float depth_step;        ///< m
};

/// Adds the irradiance by the sky to every pixel, as shade.comp and shade_isolated.comp do where nothing is
/// glossy. Tiles are of n x n pixels.
void shade_sky(const SkyShading& input, uint32_t n, const GatherOutput& output);

/// Returns the bounds of all points that a picture shows in `low` and `high`; false if there are none.
bool receiver_bounds(const CameraView& camera, const GBufferTexel* pixels, glm::vec3& low, glm::vec3& high);

}  // namespace lucarne::gi::vpl::native
