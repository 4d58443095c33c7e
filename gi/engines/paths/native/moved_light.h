#pragma once

#include <array>
#include <cstddef>
#include <span>

#include <glm/vec3.hpp>

namespace lucarne::gi::paths::native {

/// Rays of a gathering point side by side: what they met, and its light. Lanes that are not used have no
/// weight and no light.
struct RayBlock {
    static constexpr size_t kRays = 8;
    std::array<float, kRays> x{}, y{}, z{};                       ///< m
    std::array<float, kRays> normal_x{}, normal_y{}, normal_z{};  ///< of the surface there
    std::array<float, kRays> weight{};                            ///< 1 / what a ray counts at the point
    std::array<float, kRays> light{};                             ///< luminance of the radiosity, W/m^2
};

/// Sums over rays.
struct RaySums {
    float light = 0;  ///< of what they bring, W/m^2
    float times = 0;  ///< of how often they count
};

/// A ray counts at most so many times as much as at its point: what is near has been met by few.
inline constexpr float kMostTimes = 20;

/// Adds up what rays bring to another place, in an order that is the same with all instruction sets: each
/// counts by cos cos / r^2 over the same at its point. `radius2`: the square of the radius of the point's
/// disc, m^2, which is added to r^2.
RaySums add_moved(std::span<const RayBlock> blocks, const glm::vec3& place, const glm::vec3& normal,
                  float radius2);

}  // namespace lucarne::gi::paths::native
