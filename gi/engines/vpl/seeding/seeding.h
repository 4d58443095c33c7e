#pragma once

#include <span>
#include <vector>

#include <glm/vec2.hpp>

#include "gi/device/gl/device.h"
#include "gi/engines/vpl/vpl_light.h"
#include "gi/raster/gbuffer.h"

namespace lucarne::gi::vpl {

/// The VPLs of one bounce and what they are made from.
struct Seeds {
    Buffer points;                      ///< vec2 in [0, 1)^2, one a VPL
    Buffer lights;                      ///< VplLight, one a point
    std::vector<VplLight> host_lights;  ///< the same
};

/// What a light sees of its cut through one of its views (gi/lighting/light_view.h).
struct Sight {
    const Light& light;
    uint32_t face;
    CameraView view;
    const DeviceCut& cut;
    const GBuffer& seen;
};

/// The importance map of a sight (importance.glsl: vec2 (weight, lit), all mip levels), for materials that
/// are bound. The sum of its weights: the flux that leaves what the light lands on, W, lobes counted as
/// importance.comp says. Errors: no device memory, a shader that fails.
Result<double> map_importance(Device& device, const Sight& sight, Buffer& target);

/// Places one VPL a point of `points`, in [0, 1)^2, by a view's importance map, from VPL `first` of the
/// target on. Errors as above.
Result<void> seed_view(Device& device, const Sight& sight, const Buffer& importance, const Buffer& materials,
                       std::span<const glm::vec2> points, uint32_t first, Seeds& target);

/// How many of `count` VPLs each light gets: in proportion to `weights`, at least one where there is any;
/// their sum is `count` unless all weights are 0.
std::vector<uint32_t> share_out(std::span<const double> weights, uint32_t count);

/// Takes the VPLs to the host; those that stand on rims give their flux to the others there and on the
/// device.
void settle_lights(Seeds& seeds, uint32_t count);

}  // namespace lucarne::gi::vpl
