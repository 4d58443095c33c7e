#pragma once

#include <array>

#include "gi/options.h"

namespace lucarne::gi::environment {

inline constexpr Option<uint32_t> kCacheSpacing{{
    .kind = OptionKind::integer,
    .key = "cache_spacing",
    .label = "cache spacing",
    .help = "About how many pixels lie between places where light is gathered; others interpolate. Pictures "
            "larger than 250 x 250 have wider spacing: twice in 1000 x 1000",
    .cost = "pixels from one place that gathers light to the next: half as many take four times as long,\n"
            "and resolve finer shadows",
    .least = 2,
    .most = 64,
    .slider = {4, 32, true},
    .defaults = {int64_t{16}, int64_t{8}, int64_t{4}},
    .cheaper = 1,
}};

inline constexpr Option<bool> kGlossyCaches{{
    .kind = OptionKind::flag,
    .key = "glossy_caches",
    .label = "glossy caches",
    .help = "Let surfaces with a shininess of up to 28 reflect the light of caches, which is blurred by 12 "
            "degrees; else, and if they shine more, they gather by themselves. While the camera moves all "
            "reflect it",
    .cost = "a third less time for glossy scenes, and softer reflections",
    .defaults = {true, true, false},
    .cheaper = 1,
}};

inline constexpr Option<bool> kBruteForce{{
    .kind = OptionKind::flag,
    .key = "brute_force",
    .label = "brute force",
    .help = "Gather the light of every surfel, to check what leaving most of them out changes",
    .cost = "many times slower: it only serves to check the shortcuts of this engine",
    .defaults = {false, false, false},
}};

}  // namespace lucarne::gi::environment
