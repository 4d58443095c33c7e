#pragma once

#include <cstdint>
#include <span>
#include <vector>

#include <glm/vec3.hpp>

#include "gi/volume/openings.h"
#include "gi/volume/voxels.h"

namespace lucarne::gi::volume {

/// The voxels in which there is nothing, and lines of sight through them.
class Air {
 public:
    Air() = default;
    /// `surfels`: of the voxels.
    Air(const Voxels& voxels, std::span<const FlatSurfel> surfels);

    /// Returns whether nothing is on the line between two places (in units of voxels; both in the grid), its
    /// ends included: neither in voxels nor, where voxels are occupied, in blocks (openings.h). A line passes
    /// from one to the next through faces, so nothing is seen through a wall, whatever its direction. Looking
    /// back gives the same answer but for rounding where a line meets an edge.
    bool sees(const glm::vec3& from, const glm::vec3& to) const;

    /// The distance of a cell to the next occupied voxel: the largest of the three differences of their
    /// coordinates, at most 255; 0 for occupied ones.
    uint8_t distance(const glm::ivec3& cell) const { return distances_[grid_.number(cell)]; }

    /// Returns Openings::passing of an occupied voxel.
    const glm::vec3& passing(uint32_t voxel) const { return openings_.passing[voxel]; }

 private:
    bool sees_in(const glm::ivec3& cell, const glm::vec3& from, const glm::vec3& to) const;

    Grid grid_;
    std::vector<uint8_t> distances_;
    std::vector<uint32_t> numbers_;  ///< of occupied voxels, by cell
    Openings openings_;
};

}  // namespace lucarne::gi::volume
