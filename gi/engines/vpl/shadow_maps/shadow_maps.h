#pragma once

#include <cstdint>

#include "gi/device/gl/device.h"
#include "gi/device/gl/pass_times.h"
#include "gi/engines/vpl/seeding/seeding.h"
#include "gi/surfels/surfel_pool.h"

namespace lucarne::gi::vpl {

/// The layout of an atlas of imperfect shadow maps (Ritschel et al. 2008).
struct AtlasLayout {
    uint32_t maps = 0;      ///< one per VPL, one after the other in the buffer
    uint32_t side = 0;      ///< texels along a side of a map, a multiple of 8
    float splat_angle = 0;  ///< radius of the splats over their distance, rad

    size_t texels() const { return size_t{maps} * side * side; }
    size_t coarse_texels() const { return texels() / 4; }  ///< of all maps at half the resolution
};

/// Returns the layout of an atlas of about `atlas` x `atlas` texels for `maps` VPLs. Errors (arguments): no
/// VPLs, or so many that a map would have fewer than 8 x 8 texels.
Result<AtlasLayout> atlas_layout(uint32_t atlas, uint32_t maps);

/// Sets the uniforms map_side and splat_angle.
void set_layout(const Program& program, const AtlasLayout& layout);

/// The shadow maps of all VPLs. The atlas has binding 10.
struct ShadowMaps {
    AtlasLayout layout;
    Buffer atlas, coarse;
    Buffer sources;                 ///< the surfel of each texel of the atlas (sources.glsl), if requested
    uint32_t id_bits = 0;           ///< bits of the surfel ids in `sources`; 0: not requested
    Buffer fringe, fringe_sources;  ///< scratch: fringe.glsl
    Buffer casters, bounds, meetings, queues, pairs,
        large;  ///< scratch of splatting (casters.glsl, queue.glsl)
};

/// Decodes the casters for the maps of all bounces: the surfels of the cut, and the bounds of its blocks.
/// Errors: no device memory, a shader that fails.
Result<void> decode_casters(Device& device, const DeviceCut& cut, ShadowMaps& target);

/// Draws `cut`, decoded before by decode_casters(), into the maps of `seeds` and closes the holes between
/// the splats. `sources` requests which surfel each texel shows. Errors: no device memory, a shader that
/// fails.
Result<void> draw_shadow_maps(Device& device, const DeviceCut& cut, const Seeds& seeds,
                              const AtlasLayout& layout, bool sources, PassTimes& times, ShadowMaps& target);

/// The same in parts: empties the maps, draws those from `first` to before `end`, and closes the holes of
/// all.
Result<void> clear_shadow_maps(Device& device, const DeviceCut& cut, const AtlasLayout& layout, bool sources,
                               ShadowMaps& target);
Result<void> splat_shadow_maps(Device& device, const DeviceCut& cut, const Seeds& seeds, uint32_t first,
                               uint32_t end, PassTimes& times, ShadowMaps& target);
Result<void> close_shadow_maps(Device& device, PassTimes& times, ShadowMaps& target);

}  // namespace lucarne::gi::vpl
