#pragma once

#include <array>
#include <cstdint>

#include <glm/vec3.hpp>

#include "gi/volume/disc_areas.h"

namespace lucarne::gi::volume {

/// The blocks of a voxel, 4 along each axis, as the bits of a mask: x + 4 y + 16 z. A bit is set where a disc
/// touches the block.
inline constexpr int kBlocksAlong = 4;
inline constexpr uint64_t kAllBlocks = ~uint64_t{0};

inline uint64_t block_bit(const glm::ivec3& block) {
    return uint64_t{1} << (block.x + kBlocksAlong * (block.y + kBlocksAlong * block.z));
}

/// What touches a voxel may lie this far outside of it, and touches a block then, too; in blocks.
inline constexpr float kTouchingBlocks = 1.25f * kBlocksAlong * kTouching;

/// Returns the blocks in the layers from `first` to `last` along an axis.
inline uint64_t block_layers(int axis, int first, int last) {
    constexpr uint64_t kRepeated[] = {0x1111111111111111u, 0x0001000100010001u, 1};
    const int bits = 1 << (2 * axis);  // of a layer in each repetition
    return ((kAllBlocks >> (64 - bits * (last - first + 1))) << (bits * first)) * kRepeated[axis];
}

/// Returns blocks of which those that a part of a disc touches are a few: all in the box about it. `low`,
/// `high`: of the box, in units of blocks of its voxel.
uint64_t blocks_in_box(const glm::vec3& low, const glm::vec3& high);

/// Returns those of some blocks in the box about a disc that it touches (an octagon about it, which touches a
/// few more). `place`, `radius`: of the disc, in units of blocks of their voxel.
uint64_t blocks_touched(uint64_t blocks, const glm::vec3& place, const glm::vec3& normal, float radius);

/// Returns how many blocks wide gaps between discs may be: 1 (none), or up to kWidestGap, or more if voxels
/// are too small to tell gaps from openings. `radius`, `area`: of each disc and of its share of the surface,
/// in voxels.
int gap_between(float radius, float area);
/// Of squares as large as gaps are taken to be, one in e to this power is free by chance.
inline constexpr float kRarity = 16;
inline constexpr int kWidestGap = kBlocksAlong + 1;

/// Returns the blocks of the middle one of 3 x 3 x 3 voxels, and those that are free only in gaps: that no
/// free cube of `gap` blocks along each side, at most kWidestGap, holds. Where such cubes on two sides of a
/// gap touch, but none passes it, the blocks between them are not free, either. `blocks`: of the voxels, x
/// fastest.
uint64_t without_gaps(const std::array<uint64_t, 27>& blocks, int gap);

/// Returns the blocks on those columns along an axis that are free from side to side.
uint64_t free_columns(uint64_t blocks, int axis);

/// The blocks of a voxel and what is free about it.
struct AirAbout {
    bool one = false;      ///< all air about the voxel is connected through free blocks
    uint64_t reached = 0;  ///< free blocks of the voxel that are connected with it
    uint64_t apart = 0;    ///< its blocks that are, or touch, free blocks about it which are not
};
/// Looks at the middle one of 3 x 3 x 3 voxels. `blocks`: of the voxels, x fastest; `air`: bits of those that
/// are air. Without any, all free blocks must be connected.
AirAbout air_about(const std::array<uint64_t, 27>& blocks, uint32_t air);

/// Returns whether some free blocks of 3 x 3 x 3 voxels are all connected with those of the middle one, of
/// which there are some. `wanted`: by voxel.
bool connects(const std::array<uint64_t, 27>& blocks, const std::array<uint64_t, 27>& wanted);

/// Blocks of 3 x 3 x 3 voxels: three words for each layer along z, of four rows along x each. A row is the
/// lower 12 of 16 bits.
using BlockRows = std::array<uint64_t, 3 * 3 * kBlocksAlong>;

/// Returns the free blocks of 3 x 3 x 3 voxels that are connected with those of one of them, also by an edge
/// or a corner. `blocks`: of the voxels, x fastest; `voxel`: a free one, of 0 to 26.
BlockRows connected_with(const std::array<uint64_t, 27>& blocks, int voxel);
/// Returns whether a block, counted from the lowest one of the 3 x 3 x 3 voxels, is one of them.
bool holds(const BlockRows& rows, const glm::ivec3& block);

}  // namespace lucarne::gi::volume
