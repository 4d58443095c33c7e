#pragma once

#include <array>

#include "gi/options.h"

namespace lucarne::gi::vpl {

inline constexpr std::array<int64_t, 3> kInterleaves = {1, 2, 4};
inline constexpr std::array<int64_t, 6> kAtlases = {256, 512, 1024, 2048, 4096, 8192};

inline constexpr std::array<int64_t, 5> kSkyCounts = {64, 128, 256, 512, 1024};  // of 4 x 4 tiles

inline constexpr Option<uint32_t> kInterleave{{
    .kind = OptionKind::integer,
    .key = "interleave",
    .label = "interleaving",
    .help = "Pixels along a side of the interleaved pattern, which share the VPLs",
    .cost = "pixels along a side of the pattern that shares the VPLs: 4 is up to 16 times faster than 1,\n"
            "but blurs detail in indirect light",
    .least = 1,
    .most = 4,
    .values = kInterleaves,
    .slider = {1, 4, true},
    .defaults = {int64_t{4}, int64_t{4}, int64_t{1}},
    .cheaper = 1,
}};

inline constexpr Option<uint32_t> kAtlas{{
    .kind = OptionKind::integer,
    .key = "atlas",
    .label = "shadow atlas",
    .help = "Texels along a side of the shadow maps' atlas",
    .cost = "texels along a side: twice as many cost four times the memory, and make finer shadows",
    .least = 256,
    .most = 8192,
    .values = kAtlases,
    .slider = {256, 8192, true},
    .defaults = {int64_t{1024}, int64_t{1024}, int64_t{4096}},
    .cheaper = -1,
}};

inline constexpr Option<uint32_t> kSkyDirections{{
    .kind = OptionKind::integer,
    .key = "sky_directions",
    .label = "sky directions",
    .help = "Directions from which the sky lights a frame",
    .cost =
        "directions from which the sky lights a frame, each with a coarse shadow map: more of them smooth\n"
        "the light of windows, and time grows with them",
    .least = 64,
    .most = 1024,
    .values = kSkyCounts,
    .slider = {64, 1024, true},
    .defaults = {int64_t{128}, int64_t{256}, int64_t{512}},
    .cheaper = -1,
}};

inline constexpr Option<bool> kBestCandidate{{
    .kind = OptionKind::flag,
    .key = "best_candidate",
    .help = "Redistribute VPLs by the best candidate, as Preiner 2010 does (biased, for comparison)",
    .defaults = {false, false, false},
}};

inline constexpr Option<bool> kViewVpls{{
    .kind = OptionKind::flag,
    .key = "view_vpls",
    .label = "VPLs for the view",
    .help = "Favour VPLs that light the view",
    .cost =
        "chooses VPLs whose light reaches the picture: far less noise by daylight and in large buildings,\n"
        "for 128 more shadow maps whenever VPLs are made",
    .defaults = {false, true, true},
    .cheaper = -1,
}};

inline constexpr Option<bool> kReuse{{
    .kind = OptionKind::flag,
    .key = "reuse",
    .help = "Average with earlier frames while the camera moves",
    .defaults = {true, true, true},
}};

}  // namespace lucarne::gi::vpl
