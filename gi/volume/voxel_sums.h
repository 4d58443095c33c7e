#pragma once

#include <cstdint>
#include <vector>

#include <glm/vec3.hpp>

#include "gi/volume/voxel_set.h"

namespace lucarne::gi::volume {

/// What some surface adds to a voxel.
struct VoxelPart {
    uint32_t cell = 0;
    float area = 0;          ///< voxel faces
    glm::vec3 normal{0.0f};  ///< times area
    glm::vec3 albedo{0.0f};  ///< times area
};

/// Sums of parts by voxel. The order in which parts come decides about the rounding alone.
class VoxelSums {
 public:
    /// Adds parts, which become sorted by cell; those of one cell are added in their order.
    void add(std::vector<VoxelPart>& parts);
    /// Returns the means. `origin`: of the grid's coordinates, m.
    VoxelSet means(const Grid& grid, const glm::dvec3& origin) const;

 private:
    struct Sum {
        uint32_t cell;
        double area;
        glm::dvec3 normal, albedo;
    };
    std::vector<Sum> sums_;  ///< sorted by cell
};

}  // namespace lucarne::gi::volume
