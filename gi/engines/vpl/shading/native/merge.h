#pragma once

#include <cstdint>
#include <span>

#include <glm/vec4.hpp>

#include "gi/shared/camera.h"
#include "gi/shared/gbuffer.h"
#include "gi/shared/material.h"

namespace lucarne::gi::vpl::native {

/// What merging reads, one element a pixel but for the materials.
struct MergeInput {
    const CameraView& camera;
    const GBufferTexel* texels;
    std::span<const Material> materials;           ///< LUCARNE_DEVICE_MATERIALS
    const uint32_t* joints;                        ///< two words a pixel, join.h
    const glm::vec4 *irradiance, *own_irradiance;  ///< W/m^2, gather.h
};

/// Temporal reuse, history.glsl: light is irradiance, W/m^2, and the number of frames in w; surfaces are two
/// words, depth and normal. One element a pixel of its own picture.
struct MergeHistory {
    const CameraView* last_camera;  ///< null: there is no last frame
    const glm::vec4* last_light;
    const uint32_t* last_surfaces;
    float most_frames;  ///< largest number of frames in an average
    glm::vec4* next_light;
    uint32_t* next_surfaces;
};

/// Writes the indirect light of every pixel, W/(sr m^2), to `radiance`, as merge.comp does where nothing is
/// glossy: the mean over interleaved tiles of n x n pixels, averaged with `history` unless it is null, times
/// the reflectance.
void merge(const MergeInput& input, uint32_t n, const MergeHistory* history, glm::vec4* radiance);

}  // namespace lucarne::gi::vpl::native
