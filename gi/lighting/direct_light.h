#pragma once

#include <vector>

#include "gi/gl_frame.h"
#include "gi/lighting/light_view.h"

namespace lucarne::gi {

/// The direct light of a picture, in parts that engines put together. `materials` is what upload_materials
/// made; all of them work on frame.gl.radiance. Errors: the shader's, no device memory.

/// As many materials as a surfel can name (LUCARNE_DEVICE_MATERIALS). Surfels packed for an earlier scene may
/// name some that no longer exist: these become the default material, or a white diffuse one where
/// `materials` is empty.
std::vector<Material> device_materials(std::vector<Material> materials);

/// Uploads device_materials().
Result<void> upload_materials(Device& device, const std::vector<Material>& materials, Buffer& target);

/// What the camera sees where nothing is, on the device, and the light that comes from there.
struct Sky {
    Buffer texels;             ///< three floats each
    SkyDirections directions;  ///< dark without an environment: a mere background does not light
};
Result<void> upload_sky(const Frame& frame, Sky& sky);

/// Emission and background, added to the picture or, with `add` false, in the place of what it held.
Result<void> add_own_light(Frame& frame, const Buffer& materials, const Sky& sky, bool add);

/// Adds a light after one reflection, as far as one of its views shows it: BRDF * E * visibility. `seen` is
/// what rasterize() drew of that view: it serves as the shadow map.
Result<void> add_light(Frame& frame, const Buffer& materials, const LightView& from, const GBuffer& seen);

}  // namespace lucarne::gi
