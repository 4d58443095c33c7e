#include "gi/engines/volume/directions.h"

#include <cmath>

#include <glm/geometric.hpp>
#include <glm/gtc/quaternion.hpp>

#include "gi/shared/brdf.h"
#include "io/core/random.h"

namespace lucarne::gi::volume {

Directions even_directions(uint32_t count, uint64_t seed) {
    // A random unit quaternion (Shoemake 1992, "Uniform random rotations").
    Random random(seed, 0);
    const double share = random.uniform(), u = 2 * M_PI * random.uniform(), v = 2 * M_PI * random.uniform();
    const double a = std::sqrt(1 - share), b = std::sqrt(share);
    const glm::dquat turn(a * std::sin(u), a * std::cos(u), b * std::sin(v), b * std::cos(v));
    Directions directions;
    for (uint32_t i = 0; i < count; ++i) {
        const double z = 1 - (2.0 * i + 1) / count, sine = std::sqrt(1 - z * z);
        const double phi = 2 * M_PI * 0.6180339887498949 * i;
        directions.ways.push_back(
            glm::normalize(glm::vec3(turn * glm::dvec3(sine * std::cos(phi), sine * std::sin(phi), z))));
    }
    for (int side = 0; side < kSides; ++side) {
        double sum = 0;
        for (const glm::vec3& way : directions.ways)
            sum += std::max(0.0f, -way[axis_of(side)] * static_cast<float>(sign_of(side)));
        directions.weights[static_cast<size_t>(side)] = sum > 0 ? static_cast<float>(kPi / sum) : 0;
    }
    return directions;
}

}  // namespace lucarne::gi::volume
