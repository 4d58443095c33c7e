#pragma once

#include <cstdint>
#include <span>
#include <vector>

#include <glm/common.hpp>
#include <glm/vec3.hpp>

#include "octree/holes/holes.h"

namespace lucarne::octree {

inline constexpr uint32_t kNoVoxel = UINT32_MAX;

/// Means of the points of a sample in one cell of a cubic grid.
struct Voxel {
    glm::vec3 position{0.0f};
    glm::vec3 normal{0.0f};  ///< mean of the unit normals: shorter than 1 where they differ
    glm::vec3 colour{0.0f};
    float points = 0;
    uint32_t plane = UINT32_MAX;  ///< index of the plane that the voxel belongs to
};

/// The occupied cells of a grid over a sample, in the order of a Morton curve.
class Voxels {
 public:
    /// `size`: edge of a cell, m. Points without a normal are left out.
    Voxels(const HoleSample& sample, float size);

    float size() const { return size_; }
    std::span<Voxel> all() { return voxels_; }
    std::span<const Voxel> all() const { return voxels_; }
    /// Returns the voxel of a place, or kNoVoxel.
    uint32_t at(const glm::vec3& position) const { return find(cell_of(position)); }
    /// Returns a neighbour of a voxel, or kNoVoxel. `offset` is in cells.
    uint32_t neighbour(uint32_t voxel, const glm::ivec3& offset) const {
        return find(cells_[voxel] + offset);
    }
    uint32_t of_point(size_t point) const { return of_point_[point]; }

 private:
    /// 4^3 cells. Their voxels are consecutive, because a Morton curve visits them together.
    struct Brick {
        uint64_t code = UINT64_MAX;  ///< Morton code of the brick; UINT64_MAX: a free slot of the table
        uint64_t mask = 0;           ///< which cells are occupied
        uint32_t first = 0;          ///< the first voxel
    };
    glm::ivec3 cell_of(const glm::vec3& position) const;
    uint32_t find(const glm::ivec3& cell) const;
    size_t slot_of(uint64_t brick) const;
    void enter_bricks();

    glm::vec3 origin_{0.0f};
    float size_;
    std::vector<Voxel> voxels_;
    std::vector<glm::ivec3> cells_;
    std::vector<uint32_t> of_point_;
    std::vector<Brick> bricks_;  ///< hash table with open addressing
};

}  // namespace lucarne::octree
