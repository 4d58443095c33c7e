#pragma once

#include "gi/engine.h"
#include "gi/vpl/seeding.h"
#include "gi/vpl/shadow_maps.h"

namespace lucarne::gi::vpl {

/// What the VPLs send to every pixel, one pane's VPLs a pixel.
struct Panes {
    Buffer diffuse;   ///< vec4, irradiance
    Buffer specular;  ///< vec4, radiance by the receiver's lobe; one texel where nothing is glossy
};

/// Shades every pixel of the camera's G-buffer by its pane's VPLs, filters the panes into one picture and
/// writes the indirect light to frame.radiance. `materials` is what upload_materials made; `glossy` says
/// whether any of them has a specular lobe. Errors: no device memory, a shader that fails.
Result<void> shade_panes(Frame& frame, const Buffer& materials, const Seeds& seeds, const ShadowMaps& maps,
                         bool glossy, Panes& target);

}  // namespace lucarne::gi::vpl
