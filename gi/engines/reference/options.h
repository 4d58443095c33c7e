#pragma once

#include "gi/options.h"

namespace lucarne::gi::reference {

inline constexpr Option<uint32_t> kSamples{{
    .kind = OptionKind::integer,
    .key = "samples",
    .label = "paths a pixel",
    .help = "Paths per pixel and frame",
    .cost = "four times as many take four times as long and halve the noise",
    .least = 1,
    .most = 1 << 20,
    .slider = {1, 1024, true},
    .defaults = {int64_t{4}, int64_t{16}, int64_t{64}},
    .cheaper = -1,
}};

}  // namespace lucarne::gi::reference
