#pragma once

#include <algorithm>
#include <array>
#include <cmath>
#include <cstddef>
#include <cstdint>

#include <glm/common.hpp>
#include <glm/vec3.hpp>

namespace lucarne::gi::volume {

/// A box of cubes, the voxels. Cell (0, 0, 0) has its lowest corner at `low`.
struct Grid {
    glm::vec3 low{0.0f};  ///< m
    float voxel = 1;      ///< side of a voxel, m
    glm::ivec3 size{0};   ///< voxels along each axis
    bool part = false;    ///< of a larger space: beyond it there may be anything

    size_t cells() const {
        return static_cast<size_t>(size.x) * static_cast<size_t>(size.y) * static_cast<size_t>(size.z);
    }
    bool holds(const glm::ivec3& cell) const {
        return cell.x >= 0 && cell.y >= 0 && cell.z >= 0 && cell.x < size.x && cell.y < size.y &&
               cell.z < size.z;
    }
    /// The number of a cell, x fastest. The cell must be in the grid.
    uint32_t number(const glm::ivec3& cell) const {
        return static_cast<uint32_t>((cell.z * size.y + cell.y) * size.x + cell.x);
    }
    glm::ivec3 cell(uint32_t number) const {
        const auto width = static_cast<uint32_t>(size.x), height = static_cast<uint32_t>(size.y);
        return {static_cast<int>(number % width), static_cast<int>(number / width % height),
                static_cast<int>(number / width / height)};
    }
    /// Returns a place in units of voxels.
    glm::vec3 place(const glm::vec3& position) const { return (position - low) / voxel; }
    glm::vec3 position(const glm::vec3& place) const { return low + voxel * place; }
    glm::vec3 middle(const glm::ivec3& cell) const { return position(glm::vec3(cell) + 0.5f); }

    bool operator==(const Grid&) const = default;
};

/// Returns a grid about a box with `longest` voxels along its longest side (at least 4). The outermost voxels
/// on each side do not meet the box.
inline Grid grid_about(const glm::vec3& low, const glm::vec3& high, uint32_t longest) {
    const glm::vec3 extent = high - low;
    const float most = std::max({extent.x, extent.y, extent.z, 1e-4f});
    const auto inner = static_cast<float>(std::max(longest, 4u)) - 3;
    Grid grid;
    grid.voxel = most / inner;
    // The border of the box lies in the middle of a voxel: walls along the axes are then one voxel thick.
    for (int axis = 0; axis < 3; ++axis)
        grid.size[axis] = static_cast<int>(std::ceil(extent[axis] / grid.voxel - 1e-3f)) + 3;
    grid.low = low - 1.5f * grid.voxel;
    return grid;
}

/// Returns a grid of voxels half as large about a place, for half of the longest side of `coarse` along each
/// axis, or for all of an axis that is shorter. It lies in `coarse` as a whole, and ends with it where it
/// would end near to that.
inline Grid finer_grid(const Grid& coarse, const glm::vec3& position) {
    Grid grid{.voxel = coarse.voxel / 2, .part = true};
    const int extent = (std::max({coarse.size.x, coarse.size.y, coarse.size.z}) + 1) / 2;
    const glm::vec3 place = glm::clamp(coarse.place(position), glm::vec3(0.0f), glm::vec3(coarse.size));
    glm::ivec3 low(0);
    for (int axis = 0; axis < 3; ++axis) {
        const int cells = std::min(extent, coarse.size[axis]), most = coarse.size[axis] - cells;
        low[axis] = std::clamp(static_cast<int>(std::lround(place[axis])) - cells / 2, 0, most);
        // Outer walls and what is before them are in it as a whole, or not at all: light that enters between
        // voxels of a wall is not known.
        const int end = 2 * low[axis] < most ? 0 : most;
        if (std::abs(low[axis] - end) < extent / 8) low[axis] = end;
        grid.size[axis] = std::max(2 * cells - 1, 0);
    }
    // Half a voxel within whole coarse ones: what lies in the middle of those, as outermost walls do, then
    // lies in the middle of a fine one, and not in the border of two.
    grid.low = coarse.position(glm::vec3(low) + 0.25f);
    return grid;
}

/// The six sides of a voxel: +x, -x, +y, -y, +z, -z.
inline constexpr int kSides = 6;
inline int axis_of(int side) {
    return side / 2;
}
inline int sign_of(int side) {
    return side % 2 == 0 ? 1 : -1;
}
inline int opposite(int side) {
    return side ^ 1;
}
/// Returns the side of an axis that looks the way of `along`.
inline int side_of(int axis, float along) {
    return 2 * axis + (along < 0 ? 1 : 0);
}
/// Returns the step from a voxel to its neighbour.
inline glm::ivec3 step_of(int side) {
    glm::ivec3 step(0);
    step[axis_of(side)] = sign_of(side);
    return step;
}

}  // namespace lucarne::gi::volume
