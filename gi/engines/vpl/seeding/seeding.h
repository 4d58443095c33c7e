#pragma once

#include <span>
#include <vector>

#include <glm/vec2.hpp>

#include "gi/device/gl/device.h"
#include "gi/engines/vpl/vpl_light.h"
#include "gi/raster/gbuffer.h"

namespace lucarne::gi::vpl {

/// The VPLs of one bounce and the points that they are made from.
struct Seeds {
    Buffer points;                      ///< vec2 in [0, 1)^2, one per VPL
    Buffer lights;                      ///< VplLight, one per point
    std::vector<VplLight> host_lights;  ///< copy of `lights` on the host
};

/// A light view (gi/lighting/light_view.h) with its cut and its G-buffer.
struct LightGBuffer {
    const Light& light;
    uint32_t face;
    CameraView view;
    const DeviceCut& cut;
    const GBuffer& seen;
};

/// Computes the importance map of a light view (importance.glsl: vec2 (weight, lit), all mip levels) for the
/// materials of upload_materials(). Returns the sum of its weights: the flux, W, that leaves the lit
/// surfaces, with lobes counted as importance.comp says; `glossy` says whether there are any. Errors: no
/// device memory, a shader that fails.
Result<double> map_importance(Device& device, const LightGBuffer& gbuffer, const Buffer& materials,
                              bool glossy, Buffer& target);

/// Places one VPL for each of `points`, in [0, 1)^2, by the importance map of a light view, starting at VPL
/// `first` of the target. Errors as above.
Result<void> seed_view(Device& device, const LightGBuffer& gbuffer, const Buffer& importance,
                       const Buffer& materials, std::span<const glm::vec2> points, uint32_t first,
                       Seeds& target);

/// Returns how many of `count` VPLs each light gets: in proportion to `weights`, at least one for a weight
/// above 0 (while VPLs last). The sum is `count` unless all weights are 0.
std::vector<uint32_t> share_out(std::span<const double> weights, uint32_t count);

/// Returns the light that leaves a VPL, W/sr along its normal, lobes counted like diffuse light.
double leaving_light(const VplLight& light);

/// Copies the VPLs to the host and lets those on rims give their flux to the others, there and on the
/// device.
void settle_lights(Seeds& seeds, uint32_t count);

}  // namespace lucarne::gi::vpl
