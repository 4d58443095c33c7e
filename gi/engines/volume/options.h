#pragma once

#include <array>
#include <string_view>

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

/// Grids of voxels, each half as wide as the one before it.
inline constexpr Option<uint32_t> kVolumeLevels{{
    .kind = OptionKind::integer,
    .key = "volume_levels",
    .label = "levels",
    .help = "Grids of voxels: one about the scene, and finer ones, each half as wide, about what the camera "
            "sees",
    .cost = "grids of voxels: each further one has voxels half as large about what the camera sees,\n"
            "and takes about as long as the first",
    .least = 1,
    .most = 4,
    .slider = {1, 4},
    .defaults = {int64_t{1}, int64_t{1}, int64_t{1}},
    .cheaper = -1,
}};

/// Directions in which light crosses the volume after the first bounce.
inline constexpr Option<uint32_t> kSweepDirections{{
    .kind = OptionKind::integer,
    .key = "sweep_directions",
    .label = "sweep directions",
    .help = "Directions in which light of bounces after the first crosses the volume; the sky's light has "
            "four times as many",
    .cost = "directions in which light crosses the volume: time grows with them,\n"
            "and small bright surfaces light their surroundings more evenly",
    .least = 32,
    .most = 256,
    .values = kDirectionCounts,
    .slider = {32, 256, true},
    .defaults = {int64_t{64}, int64_t{64}, int64_t{128}},
    .cheaper = -1,
}};

/// How light crosses the volume.
enum class Transport : uint8_t { sweeps, sh };
inline constexpr std::array<std::string_view, 2> kTransports = {"sweeps", "sh"};

inline constexpr Option<Transport> kTransport{{
    .kind = OptionKind::choice,
    .key = "transport",
    .label = "transport",
    .help = "How light crosses the volume: along directions, or as spherical harmonics from voxel to voxel, "
            "as in "
            "the paper, which loses most far light",
    .choices = kTransports,
    .defaults = {int64_t{0}, int64_t{0}, int64_t{0}},
    .keeps = true,
}};

inline constexpr Option<uint32_t> kIterations{{
    .kind = OptionKind::integer,
    .key = "iterations",
    .label = "iterations",
    .help = "Steps of light from voxel to voxel in each bounce, with transport sh",
    .cost = "only with transport sh: time grows with them, and light comes farther",
    .least = 1,
    .most = 4096,
    .slider = {8, 512, true},
    .defaults = {int64_t{32}, int64_t{64}, int64_t{64}},
    .cheaper = -1,
}};

}  // namespace lucarne::gi::volume
