#pragma once

#include <cstdint>

#include "gi/device/gl/device.h"
#include "gi/engines/vpl/seeding/seeding.h"
#include "gi/surfels/surfel_pool.h"

namespace lucarne::gi::vpl {

/// How an atlas of imperfect shadow maps (Ritschel et al. 2008) is laid out for a cut.
struct AtlasLayout {
    uint32_t maps = 0;      ///< one a VPL, one after the other in the buffer
    uint32_t side = 0;      ///< texels along a side of a map, a multiple of 8
    float splat_angle = 0;  ///< radius of the splats over their distance, rad
    uint32_t levels = 0;    ///< of pull-push; 1 closes holes of one texel, 2 of three

    size_t texels() const { return size_t{maps} * side * side; }
    size_t coarse_texels() const;  ///< of the levels above 0, in all
};

/// An atlas of about `atlas` x `atlas` texels for `maps` VPLs. Errors (arguments): no VPLs, or so many that a
/// map would have fewer than 8 x 8 texels.
Result<AtlasLayout> atlas_layout(uint32_t atlas, uint32_t maps);

void set_layout(const Program& program, const AtlasLayout& layout);

/// The shadow maps of all VPLs. Binding 10 when bound.
struct ShadowMaps {
    AtlasLayout layout;
    Buffer atlas, coarse;
    Buffer sources;        ///< which surfel is in a texel of the atlas (sources.glsl), if it was asked for
    uint32_t id_bits = 0;  ///< of the surfels' ids there; 0: not asked for
    Buffer fringe, fringe_sources;                   ///< scratch: fringe.glsl
    Buffer casters, bounds, meetings, queue, large;  ///< scratch of splatting (casters.glsl, queue.glsl)
};

/// Decodes what the maps of all bounces are drawn from: the cut's surfels, and bounds of its blocks. Errors:
/// no device memory, a shader that fails.
Result<void> decode_casters(Device& device, const DeviceCut& cut, ShadowMaps& target);

/// Draws `cut`, decoded before, into the maps of `seeds` and closes the holes between the splats.
/// `sources` keeps which surfels they show. Errors: no device memory, a shader that fails.
Result<void> draw_shadow_maps(Device& device, const DeviceCut& cut, const Seeds& seeds,
                              const AtlasLayout& layout, bool sources, PassTimes& times, ShadowMaps& target);

}  // namespace lucarne::gi::vpl
