#pragma once

#include <array>

#include "gi/options.h"

// Options of engines with light views.
namespace lucarne::gi {

inline constexpr std::array<int64_t, 7> kLightResolutions = {64, 128, 256, 512, 1024, 2048, 4096};

/// Texels along a side of the light G-buffer and the shadow map.
inline constexpr Option<uint32_t> kLightResolution{{
    .kind = OptionKind::integer,
    .key = "light_resolution",
    .label = "light resolution",
    .help = "Texels along a side of what each light sees: the sharpness of shadows' edges",
    .cost = "texels along a side of each light's view: twice as many cost up to four times the time,\n"
            "and make sharper shadow edges",
    .least = 64,
    .most = 4096,
    .values = kLightResolutions,
    .slider = {64, 4096, true},
    .defaults = {int64_t{256}, int64_t{512}, int64_t{1024}},
    .cheaper = -1,
}};

/// Number of views per frame for lights that have a size and for the sky (light_samples.h).
inline constexpr Option<uint32_t> kLightSamples{{
    .kind = OptionKind::integer,
    .key = "light_samples",
    .label = "light samples",
    .help = "Views a frame of the lights that have a size, and of the sky",
    .cost =
        "every view is one more picture from a light: time grows with them, and soft shadows converge sooner",
    .least = 1,
    .most = 1024,
    .defaults = {int64_t{4}, int64_t{8}, int64_t{32}},
    .cheaper = -1,
}};

inline constexpr Option<uint32_t> kVpls{{
    .kind = OptionKind::integer,
    .key = "vpls",
    .label = "VPLs",
    .help = "Virtual point lights",
    .cost = "virtual point lights: time grows with them; vpl needs an atlas of shadow maps for them",
    .least = 1,
    .most = 65536,
    .slider = {16, 4096, true},
    .defaults = {int64_t{64}, int64_t{256}, int64_t{1024}},
    .cheaper = -1,
}};

}  // namespace lucarne::gi
