#pragma once

#include <array>

#include "gi/options.h"

namespace lucarne::gi::volume {

inline constexpr std::array<int64_t, 5> kGridSizes = {16, 32, 64, 96, 128};
inline constexpr std::array<int64_t, 4> kDirectionCounts = {32, 64, 128, 256};

/// Voxels along the longest side of the scene.
inline constexpr Option<uint32_t> kVoxelCount{{
    .kind = OptionKind::integer,
    .key = "voxels",
    .label = "voxels",
    .help = "Voxels along the longest side of the scene; light does not resolve what is smaller",
    .cost = "voxels along the longest side: twice as many take up to eight times as long,\n"
            "and resolve finer shadows",
    .least = 16,
    .most = 128,
    .values = kGridSizes,
    .slider = {16, 128, true},
    .defaults = {int64_t{32}, int64_t{64}, int64_t{128}},
    .cheaper = -1,
}};

/// Directions in which light crosses the volume after the first bounce.
inline constexpr Option<uint32_t> kSweepDirections{{
    .kind = OptionKind::integer,
    .key = "sweep_directions",
    .label = "sweep directions",
    .help = "Directions in which light of the sky, and of all bounces after the first, crosses the volume",
    .cost = "directions in which light crosses the volume: time grows with them,\n"
            "and small bright surfaces light their surroundings more evenly",
    .least = 32,
    .most = 256,
    .values = kDirectionCounts,
    .slider = {32, 256, true},
    .defaults = {int64_t{64}, int64_t{64}, int64_t{128}},
    .cheaper = -1,
}};

}  // namespace lucarne::gi::volume
