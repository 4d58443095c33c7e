#pragma once

#include <cstdint>
#include <span>

#include <glm/vec4.hpp>

#include "gi/shared/camera.h"
#include "gi/shared/gbuffer.h"

namespace lucarne::gi::vpl::native {

/// Where the light goes, W/m^2: that of each pixel's interleaved tile, and what isolated pixels need besides.
struct GatherOutput {
    glm::vec4 *irradiance, *own_irradiance;
    std::span<const uint32_t> isolated;  ///< pixels, ascending
    const uint32_t* joints;              ///< join.h
};

/// A picture whose pixels share their lights in tiles of n x n.
struct InterleavedPicture {
    const CameraView& camera;
    const GBufferTexel* pixels;
    int n;
    const GatherOutput& output;
};

}  // namespace lucarne::gi::vpl::native
