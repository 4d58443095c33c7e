#pragma once

#include "gi/engines/vpl/seeding/seeding.h"
#include "gi/engines/vpl/shading/history.h"
#include "gi/engines/vpl/shadow_maps/shadow_maps.h"
#include "gi/gl_frame.h"

namespace lucarne::gi::vpl {

/// What the VPLs of all bounces send to every pixel, one pane's VPLs a pixel.
struct Panes {
    Buffer diffuse;   ///< vec4, irradiance
    Buffer specular;  ///< vec4, radiance by the receiver's lobe; one texel where nothing is glossy
    Buffer own_diffuse, own_specular;  ///< the same, from the panes that lonely pixels lack
    Buffer joints, lonely;             ///< join.glsl
    bool glossy = false;
};

/// Decides which pixels' panes join to a pixel's light, and clears the light. `glossy` says whether any
/// material has a specular lobe. Errors: no device memory, a shader that fails.
Result<void> join_panes(Frame& frame, bool glossy, Panes& target);

/// Adds what these VPLs send to every pixel. `materials` is what upload_materials made. Errors: a shader that
/// fails.
Result<void> shade_panes(Frame& frame, const Buffer& materials, const Seeds& seeds, const ShadowMaps& maps,
                         Panes& target);

/// Writes the light of all panes to frame.gl.radiance, with what `history` knows if there is one (that has
/// begun the frame). Errors: a shader that fails.
Result<void> merge_panes(Frame& frame, const Buffer& materials, const Panes& panes, History* history);

}  // namespace lucarne::gi::vpl
