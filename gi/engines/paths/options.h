#pragma once

#include <array>
#include <cstdint>
#include <string_view>

#include "gi/options.h"

namespace lucarne::gi::paths {

/// The largest distance between gathering points, R+ of Yue et al. 2007, eq. 7, as a share of the scan's
/// diagonal.
inline constexpr Option<double> kPointSpacing{{
    .kind = OptionKind::number,
    .key = "point_spacing",
    .label = "point spacing",
    .help = "Largest distance between places where light is gathered, in per mille of the scan's diagonal",
    .cost = "half the distance takes four times as many places: preparation and light take longer,\n"
            "and soft shadows become sharper",
    .placeholder = "X",
    .least = 1,
    .most = 200,
    .slider = {2, 50, true},
    .defaults = {24.0, 16.0, 12.0},
    .cheaper = 1,
}};

inline constexpr std::array<int64_t, 6> kRayCounts = {64, 128, 256, 512, 1024, 2048};
inline constexpr Option<uint32_t> kGatherRays{{
    .kind = OptionKind::integer,
    .key = "gather_rays",
    .label = "gathering rays",
    .help = "Rays from each place where light is gathered",
    .cost = "memory, preparation and light take time in proportion; more make light less blotchy",
    .least = 64,
    .most = 2048,
    .values = kRayCounts,
    .slider = {64, 2048, true},
    .defaults = {int64_t{128}, int64_t{256}, int64_t{256}},
    .cheaper = -1,
}};

inline constexpr std::array<int64_t, 6> kEntryCounts = {50'000,  100'000, 200'000,
                                                        400'000, 800'000, 1'600'000};
inline constexpr Option<uint64_t> kEntryPoints{{
    .kind = OptionKind::integer,
    .key = "entry_points",
    .label = "entry points",
    .help = "About so many places where the light of lamps is computed",
    .cost = "a moved lamp takes time in proportion; more resolve smaller spots of light and sharper shadows",
    .least = 50'000,
    .most = 1'600'000,
    .values = kEntryCounts,
    .slider = {50'000, 1'600'000, true},
    .defaults = {int64_t{100'000}, int64_t{200'000}, int64_t{400'000}},
    .cheaper = -1,
}};

/// How light gets from surface to surface after it has entered.
enum class Transport : uint8_t {
    links,    ///< rays between groups: any number of bounces, no noise of photons
    photons,  ///< photon paths with four vertices, as the paper: bounces 1 to 4
};
inline constexpr std::array<std::string_view, 2> kTransports = {"links", "photons"};
inline constexpr Option<Transport> kTransport{{
    .kind = OptionKind::choice,
    .key = "bounce_by",
    .label = "bounce by",
    .help =
        "links: bounces by rays between groups of surfels; photons: by photon paths, four bounces at most",
    .cost = "photons are what the paper describes; links have less noise",
    .choices = kTransports,
    .defaults = {int64_t{0}, int64_t{0}, int64_t{0}},
    .keeps = true,
}};

/// How the sky lights surfaces.
enum class SkyLight : uint8_t {
    links,     ///< by links and gathering rays that leave the scene: smooth in one frame
    parallel,  ///< by parallel lights in the directions of the frame's light views, as the paper
};
inline constexpr std::array<std::string_view, 2> kSkyLights = {"links", "parallel"};
inline constexpr Option<SkyLight> kSkyLight{{
    .kind = OptionKind::choice,
    .key = "sky_light",
    .label = "sky light",
    .help =
        "Light of the sky by links and gathering rays that see it, or by the parallel lights of light views",
    .cost = "parallel lights are what the paper describes; they differ from frame to frame",
    .choices = kSkyLights,
    .defaults = {int64_t{0}, int64_t{0}, int64_t{0}},
    .keeps = true,
}};

}  // namespace lucarne::gi::paths
