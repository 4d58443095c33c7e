#pragma once

#include <cmath>
#include <initializer_list>

#include <glm/trigonometric.hpp>

namespace lucarne::gi {

/// Returns degrees that glm::radians() converts back to exactly these radians, preferring numbers with few
/// decimals.
inline double degrees_of(double radians) {
    const double degrees = glm::degrees(radians);
    for (const double steps : {1e2, 1e4, 1e6, 1e9}) {
        const double rounded = std::round(degrees * steps) / steps;
        if (glm::radians(rounded) == radians) return rounded;
    }
    double below = degrees, above = degrees;
    for (int i = 0; i < 4; ++i) {
        for (const double near : {below, above})
            if (glm::radians(near) == radians) return near;
        below = std::nextafter(below, -HUGE_VAL);
        above = std::nextafter(above, HUGE_VAL);
    }
    return degrees;
}

}  // namespace lucarne::gi
