#include "gi/surfels/surfel_edge.h"

#include <algorithm>
#include <cmath>
#include <cstdlib>

#include "gi/shared/edge.h"
#include "gi/shared/surfel_code.h"
#include "octree/tree/edge_line.h"

namespace lucarne::gi {
namespace {

/// Returns the number from `least` to `most` that is nearest to `value` and ends in these bits.
int nearest_ending(int value, int bits, int count, int least, int most) {
    const int step = 1 << count, low = (value & ~(step - 1)) | bits;
    int best = low;
    for (const int other : {low - step, low + step})
        if (best < least || best > most ||
            (other >= least && other <= most && std::abs(other - value) < std::abs(best - value)))
            best = other;
    return best;
}

uint32_t normal_with(uint32_t c, uint32_t code) {
    uint32_t result = 0;
    for (uint32_t half = 0; half < 2; ++half) {
        const auto value = static_cast<int16_t>(c >> 16 * half);
        const int ending = nearest_ending(value, static_cast<int>(code >> 4 * half & 15u), 4, -32767, 32767);
        result |= (static_cast<uint32_t>(ending) & 0xffffu) << 16 * half;
    }
    return result;
}

uint32_t colour_with(uint32_t d, uint32_t code) {
    uint32_t result = d & kSurfelHasNormal;
    for (uint32_t channel = 0; channel < 3; ++channel) {
        const auto value = static_cast<int>(d >> 10 * channel & 1023u);
        const int ending =
            nearest_ending(value, static_cast<int>(code >> (8 + 2 * channel) & 3u), 2, 0, 1023);
        result |= static_cast<uint32_t>(ending) << 10 * channel;
    }
    return result;
}

}  // namespace

void pack_edge(const glm::vec3& toward, float distance, PackedSurfel& surfel) {
    const float root = std::sqrt(surfel_own_area(surfel.b, 1.0f));
    const float steps = distance / root * kEdgeDistanceSteps + 0.5f;
    if (!(surfel.d & kSurfelHasNormal) || !(steps < static_cast<float>(kMostEdgeDistance) + 1)) return;
    const uint32_t distance_code = std::max(1u, static_cast<uint32_t>(std::max(steps, 0.0f)));
    // The code changes the normal a little, and with it perhaps the axis that the code refers to.
    int axis = octree::longest_axis(decode_octahedral(surfel.c));
    for (int tries = 0; tries < 2; ++tries) {
        const float u = toward[(axis + 1) % 3], v = toward[(axis + 2) % 3];
        if (!(std::abs(u) + std::abs(v) > 0)) return;
        const auto turn = static_cast<uint32_t>(std::lround(octree::turn_of(u, v) * kEdgeTurnSteps)) % 128u;
        const uint32_t code = distance_code | turn << 7;
        const uint32_t c = normal_with(surfel.c, code);
        const int found = octree::longest_axis(decode_octahedral(c));
        if (found == axis) {
            surfel.c = c;
            surfel.d = colour_with(surfel.d, code) | kSurfelHasEdge;
            return;
        }
        axis = found;
    }
}

}  // namespace lucarne::gi
