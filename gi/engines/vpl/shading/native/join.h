#pragma once

#include <cstdint>
#include <vector>

#include "gi/shared/camera.h"
#include "gi/shared/gbuffer.h"

namespace lucarne::gi::vpl::native {

/// Decides the geometry-aware gather of a picture for interleaved tiles of n x n pixels, as join.comp does.
/// Writes two words a pixel to `joints` (join.glsl) and returns the isolated pixels in their order.
std::vector<uint32_t> join(const CameraView& camera, const GBufferTexel* texels, uint32_t n,
                           uint32_t* joints);

}  // namespace lucarne::gi::vpl::native
