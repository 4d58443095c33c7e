#pragma once

#include <glm/vec2.hpp>
#include <span>

#include "gi/device/device.h"
#include "gi/gbuffer/gbuffer.h"

namespace lucarne::gi::vpl {

/// The VPLs of one bounce and what they are made from.
struct Seeds {
    Buffer importance;  ///< vec2 (weight, lit), all mip levels (importance.glsl)
    Buffer points;      ///< vec2 in [0, 1)^2, one a VPL
    Buffer lights;      ///< VplLight[points]
};

/// Places one VPL a point of `points` on what the light sees: importance map, mip chain, hierarchical warping.
/// Needs bound: materials (3) and frame constants (6). `light_gbuffer` has the size of the constants' light view.
/// Errors: no device memory, a shader that fails.
Result<void> seed_lights(Device& device, const GBuffer& light_gbuffer, std::span<const glm::vec2> points,
                         Seeds& target);

}  // namespace lucarne::gi::vpl
