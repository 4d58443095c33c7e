#pragma once

#include <array>

#include <glm/vec3.hpp>

#include "gi/shared/direction_cells.h"

namespace lucarne::gi {

/// Light that a point receives, sorted by direction, for what glossy surfaces near it reflect. gather.cl
/// makes it.
struct LightByDirection {
    /// What rays with the density cos / pi bring from one cell of directions.
    struct Cell {
        glm::vec3 light{0.0f};  ///< sum of their radiances, W/(sr m^2)
        float rays = 0;         ///< how many there are
        /// Sum of 1 over the distances of what they meet, 1/m; of the sky, and of what is reflected by lobes,
        /// 0.
        float nearness = 0;
    };
    std::array<Cell, kDirectionCells> cells{};

    /// Adds light from one direction that a surface with the normal `normal` receives beside that of the
    /// rays: so much of their mean, W/(sr m^2).
    void add_ray(const glm::vec3&, const glm::vec3& direction, const glm::vec3& light) {
        float rays = 0;
        for (const Cell& cell : cells) rays += cell.rays;
        cells[direction_cell(direction)].light += rays * light;
    }
};
static_assert(sizeof(LightByDirection) == 20 * kDirectionCells);

}  // namespace lucarne::gi
