#pragma once

#include <array>
#include <cstdint>
#include <vector>

#include <glm/vec3.hpp>

#include "gi/volume/grid.h"

namespace lucarne::gi::volume {

/// Even directions of the sphere, turned by a random rotation, for sums over all directions.
struct Directions {
    std::vector<glm::vec3> ways;  ///< unit, the way that light goes
    /// By side of a voxel: the weight of |cosine| * radiance of the directions that meet it. The sum over all
    /// of them, of the same radiance, is exactly pi times that radiance, the irradiance.
    std::array<float, kSides> weights{};
};

/// Returns `count` points of a spherical Fibonacci lattice, turned by a rotation that `seed` selects.
Directions even_directions(uint32_t count, uint64_t seed);

}  // namespace lucarne::gi::volume
