#pragma once

#include <algorithm>
#include <cstddef>
#include <cstdint>

#include <glm/common.hpp>
#include <glm/vec3.hpp>

namespace lucarne::octree {

/// Returns the cell of a direction, which must be finite, in a cube map of 6 x side x side cells: the face by
/// its longest axis, then the two other axes.
inline size_t cube_map_cell(const glm::vec3& direction, uint32_t side) {
    const glm::vec3 size = glm::abs(direction);
    const glm::length_t axis = size.x >= size.y && size.x >= size.z ? 0 : size.y >= size.z ? 1 : 2;
    const float half = 0.5f * static_cast<float>(side), scale = half / std::max(size[axis], 1e-30f);
    const auto cell = [&](float v) {
        return static_cast<size_t>(std::clamp(v * scale + half, 0.0f, static_cast<float>(side) - 0.5f));
    };
    const auto face = static_cast<size_t>(2 * axis + (direction[axis] < 0));
    return (face * side + cell(direction[(axis + 1) % 3])) * side + cell(direction[(axis + 2) % 3]);
}

}  // namespace lucarne::octree
