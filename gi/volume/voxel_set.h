#pragma once

#include <cstdint>
#include <vector>

#include <glm/vec3.hpp>

#include "gi/volume/grid.h"

namespace lucarne::gi::volume {

/// An occupied voxel and the surface in it.
struct OccupiedVoxel {
    uint32_t cell = 0;       ///< Grid::number()
    float area = 0;          ///< of the surface, m^2
    glm::vec3 normal{0.0f};  ///< unit mean; zero: unknown, or sides that cancel each other
    glm::vec3 albedo{0.0f};  ///< mean, linear Rec. 709
};

/// The occupied voxels of a grid, sorted by their cells.
struct VoxelSet {
    Grid grid;
    glm::dvec3 origin{0.0};  ///< of the grid's coordinates, m
    std::vector<OccupiedVoxel> voxels;

    /// Returns the middle of a voxel, m.
    glm::dvec3 middle(const OccupiedVoxel& voxel) const {
        return origin + glm::dvec3(grid.low) +
               (glm::dvec3(grid.cell(voxel.cell)) + 0.5) * static_cast<double>(grid.voxel);
    }
    /// Returns the area of all voxels, m^2.
    double area() const {
        double sum = 0;
        for (const OccupiedVoxel& voxel : voxels) sum += static_cast<double>(voxel.area);
        return sum;
    }
};

/// Returns the number of voxels that only one of two sets about the same grid has, for each of them.
struct Difference {
    size_t only_first = 0, only_second = 0;
    size_t all() const { return only_first + only_second; }
};
inline Difference difference(const VoxelSet& first, const VoxelSet& second) {
    Difference found;
    size_t i = 0, k = 0;
    while (i < first.voxels.size() || k < second.voxels.size()) {
        const bool from_first = i < first.voxels.size(), from_second = k < second.voxels.size();
        const uint32_t a = from_first ? first.voxels[i].cell : UINT32_MAX;
        const uint32_t b = from_second ? second.voxels[k].cell : UINT32_MAX;
        found.only_first += a < b;
        found.only_second += b < a;
        i += a <= b && from_first;
        k += b <= a && from_second;
    }
    return found;
}

}  // namespace lucarne::gi::volume
