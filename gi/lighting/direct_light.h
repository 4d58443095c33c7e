#pragma once

#include <vector>

#include "gi/gl_frame.h"
#include "gi/lighting/light_view.h"

namespace lucarne::gi {

/// The direct light of a picture, in parts that engines combine. `materials` comes from upload_materials();
/// all functions work on frame.gl.radiance. Errors: a shader that fails, no device memory.

/// Whether any material has a specular lobe.
bool glossy(const Frame& frame);

/// Returns as many materials as a surfel can refer to (LUCARNE_DEVICE_MATERIALS). Surfels packed for an
/// earlier scene may refer to materials that no longer exist; those become the default material, or a white
/// diffuse one if `materials` is empty.
std::vector<Material> device_materials(std::vector<Material> materials);

/// Uploads device_materials().
Result<void> upload_materials(Device& device, const std::vector<Material>& materials, Buffer& target);

/// The background on the device, and the light that comes from it.
struct Sky {
    Buffer texels;             ///< three floats per texel
    SkyDirections directions;  ///< dark without an environment: a plain background emits no light
};
Result<void> upload_sky(const Frame& frame, Sky& sky);

/// Adds emission and background to the picture or, if `add` is false, replaces its content by them.
Result<void> add_own_light(Frame& frame, const Buffer& materials, const Sky& sky, bool add);

/// Adds a light after one reflection, as far as one of its views shows it: BRDF * E * visibility. `seen` is
/// the G-buffer that rasterize() drew of that view; it serves as the shadow map.
Result<void> add_light(Frame& frame, const Buffer& materials, const LightView& from, const GBuffer& seen);

}  // namespace lucarne::gi
