#pragma once

#include <array>
#include <cstddef>
#include <cstdint>
#include <span>
#include <vector>

#include <glm/vec3.hpp>

#include "gi/engines/paths/gathering_points.h"
#include "gi/engines/paths/point_cells.h"

namespace lucarne::gi::paths::native {

/// Gathering points of a list of PointCells side by side, to be tested all at once.
struct PointBlock {
    static constexpr size_t kPoints = PointCells::kListed;
    std::array<float, kPoints> x{}, y{}, z{};  ///< m
    std::array<float, kPoints> normal_x{}, normal_y{}, normal_z{};
    std::array<float, kPoints> per_reach2{};  ///< 1 / m^2
    std::array<uint32_t, kPoints> numbers{};
};

/// Returns the points of PointCells::numbers() in blocks. `factor`: of the points' reaches.
std::vector<PointBlock> point_blocks(std::span<const GatheringPoint> points,
                                     std::span<const uint32_t> numbers, float factor);

/// Writes the numbers of the points whose squared_error_of() is below 1 at a place to `found`, in their
/// order, and those of a few others that rounding lets pass. `found` has room for all. Returns how many it
/// wrote.
size_t find_near(std::span<const PointBlock> blocks, float turn, const glm::vec3& position,
                 const glm::vec3& normal, uint32_t* found);

}  // namespace lucarne::gi::paths::native
