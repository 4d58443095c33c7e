#pragma once

#include <cstdint>

namespace lucarne::gi::vpl::native {

/// The texels of all maps, as shadow_maps.h describes the buffers.
struct CloseMemory {
    const uint32_t* cores;
    uint32_t* fringe;                    ///< becomes the atlas
    const uint32_t* sources = nullptr;   ///< null if sources are not requested
    uint32_t* fringe_sources = nullptr;  ///< becomes the sources
    uint32_t maps, side;
    float splat_angle;
};

/// Completes the maps as close.comp, pull.comp and push.comp do, at half their resolution.
void close_and_fill(const CloseMemory& memory);

}  // namespace lucarne::gi::vpl::native
