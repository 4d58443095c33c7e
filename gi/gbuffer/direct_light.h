#pragma once

#include <string>
#include <string_view>
#include <vector>

#include "gi/engine.h"

namespace lucarne::gi {

/// The direct light of a picture, in parts that engines put together. `materials` is what upload_materials
/// made; all of them work on frame.radiance. Errors: the shader's, no device memory.

/// A white diffuse material where there is none.
Result<void> upload_materials(Device& device, const std::vector<Material>& materials, Buffer& target);

/// Emission and background, added to the picture or, with `add` false, in the place of what it held.
Result<void> add_own_light(Frame& frame, const Buffer& materials, bool add);

/// Whether add_spot_light can draw it.
inline bool casts_shadow_map(const Light& light) {
    return light.kind == kSpotLight;
}

/// Says once, in the name of `engine`, which of the frame's lights it leaves out; `said` remembers.
void warn_of_lights_left_out(const Frame& frame, std::string_view engine, std::string& said);

/// Adds the spot's light after one reflection: BRDF * I cos / d^2 * visibility. `seen` is what rasterize()
/// drew from the light with spot_view(): it serves as the shadow map.
Result<void> add_spot_light(Frame& frame, const Buffer& materials, const Light& spot, const GBuffer& seen);

}  // namespace lucarne::gi
