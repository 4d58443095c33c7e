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

/// Shades every pixel of the camera's G-buffer by its pane's VPLs. Needs bound: materials (3), frame constants (6).
/// `glossy` says whether any material has a specular lobe. Errors: no device memory, a shader that fails.
Result<void> shade_panes(Frame& frame, const Seeds& seeds, const ShadowMaps& maps, bool glossy, Panes& target);

/// Filters the panes into one picture and writes frame.radiance: indirect light if `indirect`, direct light,
/// emission and background if `direct`.
struct MergeInput {
    const Seeds* seeds = nullptr;  ///< with `maps` and `panes`: the indirect light; null: none
    const ShadowMaps* maps = nullptr;
    const Panes* panes = nullptr;
    bool glossy = false;
    bool direct = true;
};
Result<void> merge_panes(Frame& frame, const MergeInput& input);

}  // namespace lucarne::gi::vpl
