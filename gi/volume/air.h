#pragma once

#include <cstdint>
#include <vector>

#include <glm/vec3.hpp>

#include "gi/volume/voxels.h"

namespace lucarne::gi::volume {

/// The voxels in which there is nothing, and lines of sight through them.
class Air {
 public:
    Air() = default;
    explicit Air(const Voxels& voxels);

    /// Returns whether all voxels on the line between two places (in units of voxels; both in the grid) are
    /// air, those of its ends included. A line passes from voxel to voxel through faces, so nothing is seen
    /// through a wall of voxels, whatever its direction. Looking back gives the same answer but for rounding
    /// where a line meets an edge.
    bool sees(const glm::vec3& from, const glm::vec3& to) const;

    /// The distance of a cell to the next occupied voxel: the largest of the three differences of their
    /// coordinates, at most 255; 0 for occupied ones.
    uint8_t distance(const glm::ivec3& cell) const { return distances_[grid_.number(cell)]; }

 private:
    Grid grid_;
    std::vector<uint8_t> distances_;
};

}  // namespace lucarne::gi::volume
