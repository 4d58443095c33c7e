// The order of surfels inside a node.
#pragma once

#include <algorithm>
#include <cstdint>
#include <utility>
#include <vector>

#include <glm/common.hpp>
#include <glm/vec3.hpp>

#include "gi/shared/surfel.h"

namespace lucarne::gi {

/// Orders surfels so that every prefix is about as even as the whole, as the octree builder does: along a
/// curve through space, in the order of the mirrored digits of their indices.
inline void order_evenly(std::vector<Surfel>& surfels) {
    glm::vec3 low(3e38f), high(-3e38f);
    for (const Surfel& s : surfels) {
        low = glm::min(low, s.position);
        high = glm::max(high, s.position);
    }
    const auto place = [&](const Surfel& s) {
        const glm::vec3 at = (s.position - low) / glm::max(high - low, 1e-6f) * 1023.0f;
        uint32_t code = 0;
        for (int bit = 9; bit >= 0; --bit)
            for (int axis = 0; axis < 3; ++axis)
                code = code << 1 | (static_cast<uint32_t>(at[axis]) >> bit & 1);
        return code;
    };
    std::vector<std::pair<uint32_t, uint32_t>> curve, order;
    for (const Surfel& s : surfels) curve.emplace_back(place(s), static_cast<uint32_t>(curve.size()));
    std::sort(curve.begin(), curve.end());
    for (uint32_t i = 0; i < curve.size(); ++i) {
        uint32_t mirrored = 0;
        for (uint32_t bit = 0; bit < 32; ++bit) mirrored |= (i >> bit & 1) << (31 - bit);
        order.emplace_back(mirrored, curve[i].second);
    }
    std::sort(order.begin(), order.end());
    std::vector<Surfel> sorted;
    for (const auto& [key, i] : order) sorted.push_back(surfels[i]);
    surfels = std::move(sorted);
}

}  // namespace lucarne::gi
