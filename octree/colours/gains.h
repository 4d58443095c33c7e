#pragma once

#include <array>
#include <cstddef>
#include <cstdint>
#include <vector>

namespace lucarne::octree {

/// How much brighter station a shows a patch of surface than station b does: 3 logarithms to base 2, in
/// kLogSteps, of the ratio of linear colours.
struct PatchRatio {
    uint16_t a = 0, b = 0;
    std::array<int16_t, 3> ratio{};
};
inline constexpr double kLogSteps = 1024;

/// Solves one gain for each station and channel (as a logarithm to base 2) so that stations agree on the
/// patches that they share. Based on the gain compensation of Brown & Lowe, "Automatic Panoramic Image
/// Stitching using Invariant Features", 2007, section 6, in logarithms, and with medians instead of means:
/// it minimises
///
///     sum over pairs (l_a - l_b + m_ab)^2 / s_ab^2 + sum over stations l_a^2
///
/// with m_ab the median of the pair's ratios and s_ab its standard error. The second sum, which expects gains
/// within a stop of 1, keeps long chains of stations from drifting; it also makes the product of the gains of
/// stations that are connected 1. Pairs that share fewer than 24 patches are left out. The result does not
/// depend on the order of `ratios`. Stations without a pair get 0.
std::vector<std::array<double, 3>> solve_gains(std::vector<PatchRatio> ratios, size_t stations);

}  // namespace lucarne::octree
