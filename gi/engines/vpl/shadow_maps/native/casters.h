#pragma once

#include <array>
#include <cmath>
#include <cstddef>

#include "gi/engines/vpl/shadow_maps/splats.h"

namespace lucarne::gi::vpl::native {

/// Radii and scales of casters by their codes, see casters.glsl and enqueue.comp.
struct CasterTables {
    std::array<float, 128> radii, scales;
    CasterTables(float cut_size, float splat_angle) {
        const float needed = thinned_area(splat_angle);
        for (size_t code = 0; code < 128; ++code) {
            const float steps = static_cast<float>(code) - 127;
            radii[code] = code ? std::exp2(steps / 6) * cut_size : 0.0f;
            scales[code] = std::exp2(steps * 0.25f) * cut_size * cut_size / needed;
        }
    }
};

}  // namespace lucarne::gi::vpl::native
