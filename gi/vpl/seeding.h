#pragma once

#include <span>
#include <vector>

#include <glm/vec2.hpp>

#include "gi/device/device.h"
#include "gi/gbuffer/gbuffer.h"
#include "gi/vpl/vpl_light.h"

namespace lucarne::gi::vpl {

/// The VPLs of one bounce and what they are made from.
struct Seeds {
    Buffer importance;                  ///< vec2 (weight, lit), all mip levels (importance.glsl)
    Buffer points;                      ///< vec2 in [0, 1)^2, one a VPL
    Buffer lights;                      ///< VplLight, one a point
    std::vector<VplLight> host_lights;  ///< the same
};

/// Places one VPL a point of `points` on what `spot` sees of `cut`, which `seen` holds (rasterized with
/// spot_view()): importance map, mip chain, hierarchical warping. `materials` is what upload_materials made.
/// Errors: no device memory, a shader that fails.
Result<void> seed_lights(Device& device, const Light& spot, const CameraView& view, const DeviceCut& cut,
                         const GBuffer& seen, const Buffer& materials, std::span<const glm::vec2> points,
                         Seeds& target);

}  // namespace lucarne::gi::vpl
