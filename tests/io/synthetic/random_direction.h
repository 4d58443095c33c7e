#pragma once

#include <cmath>

#include <glm/vec3.hpp>

#include "io/core/random.h"

namespace lucarne::io {

/// Draws a direction evenly from the whole sphere.
inline glm::dvec3 random_direction(Random& random) {
    const double z = 2 * random.uniform() - 1, angle = 2 * M_PI * random.uniform(), r = std::sqrt(1 - z * z);
    return {r * std::cos(angle), r * std::sin(angle), z};
}

}  // namespace lucarne::io
