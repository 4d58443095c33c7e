#pragma once

#include <cmath>
#include <cstdint>

namespace lucarne::gi::vpl {

/// Variance of the Gaussian that stands for a VPL's footprint where a lobe meets it, over that of the disc
/// (lobes.glsl). A single picture needs 6, which gives a standard deviation of .7 of the distance between
/// VPLs; with less they show one by one. Averaged frames have new VPLs each, so the variance may fall, and
/// the blur with it, so that their mean converges (after: Knaus & Zwicker 2011, "Progressive photon mapping:
/// a probabilistic approach", section 3; their exponent is 1/3, here it is larger for short averages).
inline float footprint_variance(uint64_t frame_index) {
    return 6.0f / std::sqrt(1.0f + static_cast<float>(frame_index));
}

}  // namespace lucarne::gi::vpl
