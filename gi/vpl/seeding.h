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
    std::vector<Buffer> importance;     ///< a light's: vec2 (weight, lit), all mip levels (importance.glsl)
    Buffer points;                      ///< vec2 in [0, 1)^2, one a VPL
    Buffer lights;                      ///< VplLight, one a point
    std::vector<VplLight> host_lights;  ///< the same
};

/// What a light sees of its cut: rasterized with spot_view().
struct LightView {
    const Light& light;
    CameraView view;
    const DeviceCut& cut;
    const GBuffer& seen;
};

/// Places `count` VPLs on what the lights see, shared out among them by the light they land and surfaces give
/// back: importance map, mip chain, hierarchical warping. The same for the same `seed`. `materials` is what
/// upload_materials made. Errors: no device memory, a shader that fails.
Result<void> seed_lights(Device& device, std::span<const LightView> views, const Buffer& materials,
                         uint32_t count, uint64_t seed, Seeds& target);

/// The importance map of what a light sees, with its mip chain, for materials that are bound. The sum of its
/// weights: the flux that leaves what the light lands on, W, lobes counted as importance.comp says. Errors as
/// above.
Result<double> map_importance(Device& device, const LightView& view, Buffer& target);

/// Places one VPL a point of `points`, in [0, 1)^2, by a view's importance map, from VPL `first` of the
/// target on. Errors as above.
Result<void> seed_view(Device& device, const LightView& view, const Buffer& importance,
                       const Buffer& materials, std::span<const glm::vec2> points, uint32_t first,
                       Seeds& target);

/// How many of `count` VPLs each light gets: in proportion to `weights`, at least one where there is any;
/// their sum is `count` unless all weights are 0.
std::vector<uint32_t> share_out(std::span<const double> weights, uint32_t count);

/// Takes the VPLs to the host; those that stand on rims give their flux to the others there and on the
/// device.
void settle_lights(Seeds& seeds, uint32_t count);

}  // namespace lucarne::gi::vpl
