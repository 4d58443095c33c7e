#pragma once

#include "gi/options.h"

// Options shared by all engines that follow light from surface to surface.
namespace lucarne::gi {

/// Number of indirect bounces; 0: direct light alone.
inline constexpr Option<uint32_t> kBounces{{
    .kind = OptionKind::integer,
    .key = "bounces",
    .label = "bounces",
    .help = "Indirect bounces; 0: direct light alone",
    .cost = "time grows with them: in vpl every bounce draws shadow maps of its own,\n"
            "in reference paths become longer",
    .least = 0,
    .most = 64,
    .slider = {0, 8},
    .defaults = {int64_t{1}, int64_t{3}, int64_t{3}},
    .keeps = true,
}};

/// Computes this bounce alone; 0: direct light, -1: all bounces.
inline constexpr Option<int32_t> kOnlyBounce{{
    .kind = OptionKind::integer,
    .key = "only_bounce",
    .label = "only bounce",
    .help = "Compute this bounce alone; 0: direct light",
    .placeholder = "K",
    .least = 0,
    .most = 64,
    .unset = "all",
    .slider = {-1, 8},
    .defaults = {int64_t{-1}, int64_t{-1}, int64_t{-1}},
    .keeps = true,
}};

/// Whether the picture shows direct light and emission, and whether it shows indirect light.
inline bool wants_direct(const EngineSettings& s) {
    return s[kOnlyBounce] <= 0;
}
inline bool wants_indirect(const EngineSettings& s) {
    return s[kOnlyBounce] < 0 ? s[kBounces] > 0 : s[kOnlyBounce] > 0;
}

inline constexpr Option<uint64_t> kSeed{{
    .kind = OptionKind::integer,
    .key = "seed",
    .label = "seed",
    .help = "Seed of all random numbers",
    .least = 0,
    .most = 9007199254740991,  // 2^53 - 1: every reader of JSON represents it exactly
    .defaults = {int64_t{1}, int64_t{1}, int64_t{1}},
    .keeps = true,
}};

}  // namespace lucarne::gi
