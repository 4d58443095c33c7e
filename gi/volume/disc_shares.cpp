#include "gi/volume/disc_shares.h"

#include <algorithm>
#include <cmath>

#include <glm/common.hpp>
#include <glm/exponential.hpp>

#include "gi/shared/brdf.h"
#include "gi/volume/blocks.h"
#include "gi/volume/disc_areas.h"

namespace lucarne::gi::volume {
namespace {

/// Smaller shares may come from rounding alone.
constexpr float kLeastShare = 1e-6f;

/// A border between voxels that cuts a disc, across an axis.
struct Border {
    int axis = 0;
    float distance = 0;  ///< from the disc's middle in its plane, radii
    float below = 0;     ///< share of the disc before it
    float reach = 0;     ///< of the disc along the axis, voxels
};

/// disc_share() of two lines. `share1`, `share2`: those of each.
float share_before_both(float d1, float d2, float cosine, float share1, float share2) {
    const float sine2 = std::max(1 - cosine * cosine, 1e-6f);
    if (d1 * d1 + d2 * d2 - 2 * cosine * d1 * d2 >= sine2) {
        // The lines do not meet in the disc: each of them lies on one side of the other.
        const bool first_before = cosine * d1 <= d2, second_before = cosine * d2 <= d1;
        if (first_before && second_before) return share1 + share2 - 1;
        return first_before ? share1 : second_before ? share2 : 0;
    }
    // Green's theorem for the wedge from where the lines meet to their ends a and b on the circle. The first
    // line is x = d1.
    const float sine = std::sqrt(sine2), h1 = std::sqrt(1 - d1 * d1), h2 = std::sqrt(1 - d2 * d2);
    const float px = d1, py = (d2 - cosine * d1) / sine;
    const float ax = d1, ay = -h1, bx = cosine * d2 - sine * h2, by = sine * d2 + cosine * h2;
    float arc = std::atan2(bx * ay - by * ax, ax * bx + ay * by);
    if (arc < -1e-6f) arc += 2 * kPi;
    arc = std::max(arc, 0.0f);  // rounding, where the lines meet on the circle
    const float twice = arc - (px * ay - py * ax) - (bx * py - by * px);
    return std::clamp(twice / (2 * kPi), 0.0f, 1.0f);
}

}  // namespace

float disc_share(float distance) {
    const float d = std::clamp(distance, -1.0f, 1.0f);
    return std::clamp(1 - (std::acos(d) - d * std::sqrt(1 - d * d)) / kPi, 0.0f, 1.0f);
}

float disc_share(float first, float second, float cosine) {
    const float d1 = std::clamp(first, -1.0f, 1.0f), d2 = std::clamp(second, -1.0f, 1.0f);
    return share_before_both(d1, d2, cosine, disc_share(d1), disc_share(d2));
}

size_t few_parts(const DiscBatch& discs, size_t disc, std::array<DiscPart, 4>& parts) {
    std::array<Border, 2> borders;
    size_t count = 0;
    glm::ivec3 first;
    uint64_t box = kAllBlocks;  // of the first cell, along the axes that no border cuts
    for (int axis = 0; axis < 3; ++axis) {
        const auto k = static_cast<size_t>(axis);
        const int last = discs.last[k][disc], low = discs.low_block[k][disc];
        first[axis] = discs.first[k][disc];
        if (last == first[axis]) {
            box &= block_layers(axis, std::min(low, kBlocksAlong - 1),
                                std::min(discs.high_block[k][disc], kBlocksAlong - 1));
            continue;
        }
        if (last - first[axis] > 1 || count == borders.size()) return 0;
        borders[count++] = {axis, std::clamp(discs.distance[k][disc], -1.0f, 1.0f), discs.below[k][disc],
                            discs.radius[disc] * discs.across[k][disc]};
    }
    parts[0] = {first, 1, box};
    if (count == 0) return 1;
    // A disc that ends so near to a border touches both voxels.
    if (count == 1) borders[0].below = std::clamp(borders[0].below, 2 * kLeastShare, 1 - 2 * kLeastShare);
    float both = 0;  // the share before both borders
    if (count == 2) {
        const auto& [u, v] = borders;
        const auto ku = static_cast<size_t>(u.axis), kv = static_cast<size_t>(v.axis);
        // Along a normal the disc reaches so little that lines in its plane mean nothing.
        if (std::min(u.reach, v.reach) < 4 * kTouching) return 0;
        const float cosine = -discs.normal[ku][disc] * discs.normal[kv][disc] /
                             (discs.across[ku][disc] * discs.across[kv][disc]);
        // Rounding may leave nothing between the limits.
        both = share_before_both(u.distance, v.distance, cosine, u.below, v.below);
        both = std::min({std::max({both, u.below + v.below - 1, 0.0f}), u.below, v.below});
    }
    uint64_t boxes[2][2];  // by border and side of it
    for (size_t k = 0; k < count; ++k) {
        const int axis = borders[k].axis, most = kBlocksAlong - 1;
        const auto of = static_cast<size_t>(axis);
        boxes[k][0] = block_layers(axis, std::min(discs.low_block[of][disc], most), most);
        boxes[k][1] = block_layers(axis, 0, std::clamp(discs.high_block[of][disc] - kBlocksAlong, 0, most));
    }
    size_t found = 0;
    for (size_t i = 0; i < size_t{1} << count; ++i) {
        DiscPart part{first, 1, box};
        for (size_t k = 0; k < count; ++k) {
            const size_t upper = i >> k & 1;
            part.cell[borders[k].axis] += static_cast<int>(upper);
            part.box &= boxes[k][upper];
        }
        const float u = borders[0].below, v = borders[1].below;
        if (count == 1)
            part.share = i == 0 ? u : 1 - u;
        else
            part.share = i == 0 ? both : i == 1 ? v - both : i == 2 ? u - both : 1 - u - v + both;
        if (part.share > kLeastShare) parts[found++] = part;
    }
    return found;
}

}  // namespace lucarne::gi::volume
