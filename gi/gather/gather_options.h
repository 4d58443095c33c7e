#pragma once

#include <array>
#include <cstdint>
#include <string_view>

#include "gi/options.h"

// Options of engines that gather light at points.
namespace lucarne::gi {

inline constexpr std::array<int64_t, 5> kBufferSides = {8, 12, 16, 24, 32};
inline constexpr std::array<int64_t, 3> kGatherSteps = {1, 2, 4};

inline constexpr Option<uint32_t> kMicroBuffer{{
    .kind = OptionKind::integer,
    .key = "micro_buffer",
    .label = "micro-buffer",
    .help = "Side of the micro-buffers: as many directions as its square at every point that gathers",
    .cost = "directions along a side: twice as many take four times as long, and resolve finer shadows",
    .least = 8,
    .most = 32,
    .values = kBufferSides,
    .slider = {8, 32, true},
    .defaults = {int64_t{8}, int64_t{16}, int64_t{24}},
    .cheaper = -1,
}};

inline constexpr Option<uint32_t> kGatherEvery{{
    .kind = OptionKind::integer,
    .key = "gather_every",
    .label = "gather every",
    .help = "Gather at every pixel (1), or every 2nd or 4th along both axes and interpolate between them",
    .cost = "pixels from one that gathers to the next: 4 is up to 16 times faster than 1, but blurs detail\n"
            "in indirect light",
    .least = 1,
    .most = 4,
    .values = kGatherSteps,
    .slider = {1, 4, true},
    .defaults = {int64_t{4}, int64_t{4}, int64_t{1}},
    .cheaper = 1,
}};

inline constexpr Option<uint32_t> kRadiosityLevel{{
    .kind = OptionKind::integer,
    .key = "radiosity_level",
    .label = "radiosity level",
    .help =
        "Logarithm (base 2) of the number of places between which light is exchanged before the last bounce",
    .cost = "one more doubles the time for every bounce but the last, and resolves its shadows more finely",
    .least = 4,
    .most = 18,
    .slider = {8, 16},
    .defaults = {int64_t{10}, int64_t{12}, int64_t{14}},
    .cheaper = -1,
}};

/// How light comes to the surfels that pixels gather from, after its first reflection.
enum class LightPoints : uint8_t { radiosity, photons, vpls };
inline constexpr std::array<std::string_view, 3> kLightPointKinds = {"radiosity", "photons", "vpls"};
inline constexpr Option<LightPoints> kLightPoints{{
    .kind = OptionKind::choice,
    .key = "light_points",
    .label = "light points",
    .help = "How light is exchanged before the last bounce: between places, by photons, or by VPLs; photons "
            "and VPLs keep specular light directed",
    .cost = "photons take seconds for each set of points first, and are right where places are too few; VPLs "
            "do not,\n"
            "and have more noise where most light falls on what nobody sees",
    .choices = kLightPointKinds,
    .defaults = {int64_t{0}, int64_t{0}, int64_t{1}},
    .cheaper = -1,
}};

inline constexpr Option<uint64_t> kPhotons{{
    .kind = OptionKind::integer,
    .key = "photons",
    .label = "photons",
    .help = "Photons that leave lit surfaces, with light points photons",
    .cost = "twice as many take twice as long for every bounce but the last, and have less noise",
    .least = 1000,
    .most = 1e9,
    .slider = {65536, 16777216, true},
    .defaults = {int64_t{262144}, int64_t{1048576}, int64_t{1048576}},
    .cheaper = -1,
}};

/// How the light of lights finds what is in its way.
enum class Shadows : uint8_t { maps, rays };
inline constexpr std::array<std::string_view, 2> kShadowKinds = {"maps", "rays"};
inline constexpr Option<Shadows> kShadows{{
    .kind = OptionKind::choice,
    .key = "shadows",
    .label = "shadows",
    .help = "Shadows of lights and bright skies by maps of what lights see, or by rays; while the camera "
            "moves always by maps",
    .cost = "rays make exact edges, and lights with a size soft in one frame; their time grows with pixels,\n"
            "surfels and light samples",
    .choices = kShadowKinds,
    .defaults = {int64_t{0}, int64_t{1}, int64_t{1}},
    .cheaper = -1,
}};

/// What a node of the tree covers of a micro-buffer.
enum class Fill : uint8_t { rays, pixels };
inline constexpr std::array<std::string_view, 2> kFillKinds = {"rays", "pixels"};
inline constexpr Option<Fill> kFill{{
    .kind = OptionKind::choice,
    .key = "fill",
    .label = "",  // for comparisons alone
    .help = "What surfaces cover in micro-buffers: those pixels whose ray meets them, or the one at their "
            "middle",
    .cost = "pixels are faster and leave holes in near surfaces, through which light shines",
    .choices = kFillKinds,
    .defaults = {int64_t{0}, int64_t{0}, int64_t{0}},
    .cheaper = 1,
}};

/// Which directions the micro-buffers of specular lobes have.
enum class Warp : uint8_t { lobe, hemisphere };
inline constexpr std::array<std::string_view, 2> kWarpKinds = {"lobe", "hemisphere"};
inline constexpr Option<Warp> kWarp{{
    .kind = OptionKind::choice,
    .key = "warp",
    .label = "",  // for comparisons alone
    .help = "Directions of the micro-buffers of specular lobes: those of the lobe, or a half space",
    .cost = "both take as long; narrow lobes find hardly any direction of a half space",
    .choices = kWarpKinds,
    .defaults = {int64_t{0}, int64_t{0}, int64_t{0}},
    .cheaper = 0,
}};

}  // namespace lucarne::gi
