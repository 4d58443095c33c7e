#pragma once

#include <cstdint>

#include <glm/vec3.hpp>

#include "gi/volume/polygon.h"

namespace lucarne::gi::volume {

/// The blocks of a voxel, 4 along each axis, as the bits of a mask: x + 4 y + 16 z. A bit is set where a disc
/// touches the block.
inline constexpr int kBlocksAlong = 4;
inline constexpr uint64_t kAllBlocks = ~uint64_t{0};

inline uint64_t block_bit(const glm::ivec3& block) {
    return uint64_t{1} << (block.x + kBlocksAlong * (block.y + kBlocksAlong * block.z));
}

/// Returns the blocks that a part of a disc touches. `part`: in units of voxels, in the voxel at `cell`.
/// `radius`: of the disc, in voxels: gaps between discs are about as large, so blocks are joined, or are the
/// voxel as a whole, until they are large enough to close them.
uint64_t blocks_of(const Polygon& part, const glm::ivec3& cell, float radius);

/// Returns the blocks on those columns along an axis that are free from side to side.
uint64_t free_columns(uint64_t blocks, int axis);

/// Returns whether what is free in the middle one of 3 x 3 x 3 voxels, from side to side, is connected with
/// all that is free from side to side in the others: then no wall is between them. `blocks`: of the voxels, x
/// fastest.
bool connects_all(const uint64_t (&blocks)[27]);

}  // namespace lucarne::gi::volume
