#pragma once

#include "gi/options.h"

// Options that every engine shares which follows light from surface to surface.
namespace lucarne::gi {

/// Indirect bounces; 0: direct light alone.
inline constexpr Option<uint32_t> kBounces{{
    .kind = OptionKind::integer,
    .key = "bounces",
    .label = "bounces",
    .help = "Indirect bounces; 0: direct light alone",
    .cost = "vpl: the lights are shared out among the bounces, so more cost little and are coarser;\n"
            "reference: time grows with them",
    .least = 0,
    .most = 64,
    .slider = {0, 8},
    .defaults = {int64_t{1}, int64_t{1}, int64_t{1}},
    .keeps = true,
}};

/// Just this bounce, 0: direct light; -1: all.
inline constexpr Option<int32_t> kOnlyBounce{{
    .kind = OptionKind::integer,
    .key = "only_bounce",
    .label = "only bounce",
    .help = "Just this bounce; 0: direct light",
    .placeholder = "K",
    .least = 0,
    .most = 64,
    .unset = "all",
    .slider = {-1, 8},
    .defaults = {int64_t{-1}, int64_t{-1}, int64_t{-1}},
    .keeps = true,
}};

inline constexpr Option<uint64_t> kSeed{{
    .kind = OptionKind::integer,
    .key = "seed",
    .label = "seed",
    .help = "Seed of all random numbers",
    .least = 0,
    .most = 9007199254740991,  // what every reader of JSON holds exactly
    .defaults = {int64_t{1}, int64_t{1}, int64_t{1}},
    .keeps = true,
}};

}  // namespace lucarne::gi
