#pragma once

#include <span>

#include "gi/shared/surfel.h"
#include "gi/shared/surfel_code.h"

namespace lucarne::gi {

/// Returns the area floor of the deepest item of a cut around a surfel of `item`. The same walk as
/// surfel_area_floor() in gi/shared/cut.glsl.
inline float local_floor(std::span<const CutItem> items, const CutItem& item, uint a, uint b) {
    const CutItem* at = &item;
    for (uint32_t depth = 0; at->inner && depth < kOctantLevels; ++depth) {
        const int child = at->child[surfel_octant(a, b, depth)];
        if (child == kWholeOctant) return 0.0f;
        if (child < 0) break;
        at = &items[static_cast<size_t>(child)];
    }
    return at->area_floor;
}

}  // namespace lucarne::gi
