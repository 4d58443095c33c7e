#pragma once

#include <cstdint>
#include <functional>
#include <span>

#include "gi/engines/vpl/seeding/seeding.h"
#include "gi/engines/vpl/shading/history.h"
#include "gi/engines/vpl/shadow_maps/shadow_maps.h"
#include "gi/gl_frame.h"

namespace lucarne::gi::vpl {

/// The light of the VPLs of all bounces at every pixel. Each pixel belongs to an interleaved tile and
/// has the light of the VPLs of that tile.
struct Tiles {
    Buffer diffuse;   ///< vec4, irradiance
    Buffer specular;  ///< vec4, radiance by the receiver's lobe; one texel where nothing is glossy
    Buffer own_diffuse, own_specular;  ///< the same for isolated pixels, from the tiles they lack
    Buffer joints, isolated;           ///< join.glsl, join.comp
    bool glossy = false;
};

/// Decides from which pixels the light of each pixel is gathered, and clears the light. `glossy` says
/// whether any material has a specular lobe. Errors: no device memory, a shader that fails.
Result<void> join_tiles(Frame& frame, bool glossy, Tiles& target);

/// Returns the isolated pixels of mapped Tiles::isolated, ascending.
std::span<const uint32_t> isolated_pixels(const MappedBuffer& isolated);

/// Adds the light of these VPLs, whose maps are `atlas`, to every pixel. `materials` comes from
/// upload_materials(). Errors: a shader that fails.
Result<void> shade_tiles(Frame& frame, const Buffer& materials, const Seeds& seeds, const AtlasLayout& layout,
                         const Buffer& atlas, Tiles& target);

/// Adds the light of `lights` lights by shade.comp and shade_isolated.comp, compiled with `more` defines;
/// `prepare` sets the uniforms of the lights, whose buffers are bound. Errors: a shader that fails.
Result<void> run_shading(Frame& frame, const Buffer& materials, uint32_t lights, const Defines& more,
                         const Tiles& target, const std::function<void(const Program&)>& prepare);

/// Writes the gathered light of all tiles to frame.gl.radiance, averaged with `history` unless it is null;
/// History::begin() must have been called for the frame. Errors: a shader that fails.
Result<void> merge_tiles(Frame& frame, const Buffer& materials, const Tiles& tiles, History* history);

}  // namespace lucarne::gi::vpl
