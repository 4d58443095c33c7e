#pragma once

#include <algorithm>
#include <cstdint>
#include <cstdlib>
#include <vector>

#include "gi/engines/vpl/shading/merging.h"

namespace lucarne::gi::vpl::native {

/// A pixel from which the light of a tile may be gathered: its offset from the receiver, window_pixel() in
/// join.glsl, its bit in the receiver's joint, and its weight, candidate_weight().
struct Candidate {
    int dx, dy;
    uint32_t word, bit;
    float weight;
};

constexpr int candidates_of_tile(int n) {
    return n > 1 ? 4 : 1;
}

/// Returns the candidates of all n x n tiles, candidates_of_tile() for each. Offsets are at most n pixels.
inline std::vector<Candidate> candidates(int n) {
    std::vector<Candidate> all;
    for (int i = 0; i < n * n; ++i)
        for (int j = 0; j < candidates_of_tile(n); ++j) {
            const int x = i % n - (n - 1) / 2, y = i / n - (n - 1) / 2;
            const auto axis = [&](int distance, bool other) { return other ? distance : n - distance; };
            const int area = axis(std::abs(x), j & 1) * axis(std::abs(y), j >> 1);
            all.push_back({x + n * (x < 0 ? 1 : -1) * (j & 1), y + n * (y < 0 ? 1 : -1) * (j >> 1),
                           static_cast<uint32_t>(i >> 3), 1u << (4 * (i & 7) + j),
                           std::max(static_cast<float>(area), kLeastCandidateWeight)});
        }
    return all;
}

/// Returns the tiles of which an isolated pixel finds no light, see missing_tiles() and window_tile() in
/// join.glsl.
inline uint32_t lacking_tiles(const uint32_t* joint, int n, int x, int y) {
    uint32_t lacking = 0;
    for (int i = 0; i < n * n; ++i) {
        if (joint[i >> 3] >> (4 * (i & 7)) & 15) continue;
        const int column = (x + i % n - (n - 1) / 2 + 2 * n) % n, row = (y + i / n - (n - 1) / 2 + 2 * n) % n;
        lacking |= 1u << (row * n + column);
    }
    return lacking;
}

}  // namespace lucarne::gi::vpl::native
