#pragma once

#include <array>
#include <cmath>

#include "gi/shared/surfel_code.h"

namespace lucarne::gi::native {

/// Roots of the surfels' own areas by code, in sides of their cubes; 0: unknown.
inline const std::array<float, 256>& area_roots() {
    static const std::array<float, 256> roots = [] {
        std::array<float, 256> made{};
        for (uint32_t code = 0; code < 256; ++code) made[code] = std::sqrt(surfel_own_area(code << 16, 1.0f));
        return made;
    }();
    return roots;
}

}  // namespace lucarne::gi::native
