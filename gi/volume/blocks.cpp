#include "gi/volume/blocks.h"

#include <algorithm>
#include <array>
#include <cmath>

#include <glm/common.hpp>

#include "gi/volume/disc_areas.h"

namespace lucarne::gi::volume {
namespace {

/// Discs at random places leave gaps. Rooms of such discs are closed, and so exactly black, if blocks are
/// this many radii large, and are not with 2.
constexpr float kRadiiABlock = 2.5f;
/// What touches a voxel may lie this far outside of it, and touches a block then, too.
constexpr float kTouchingBlocks = 1.25f * kBlocksAlong * kTouching;

constexpr int kAlong = 3 * kBlocksAlong;
/// Blocks of 3 x 3 x 3 voxels: a row along x is a number of 12 bits.
using Rows = std::array<uint16_t, size_t{kAlong} * kAlong>;

/// Sets the bits of a mask's voxel in rows.
void put(Rows& rows, uint64_t mask, int voxel) {
    const int x = voxel % 3 * kBlocksAlong, y = voxel / 3 % 3 * kBlocksAlong, z = voxel / 9 * kBlocksAlong;
    for (int i = 0; i < kBlocksAlong * kBlocksAlong; ++i) {
        const auto row = static_cast<uint16_t>((mask >> (kBlocksAlong * i) & 15u) << x);
        const int at = (z + i / kBlocksAlong) * kAlong + y + i % kBlocksAlong;
        rows[static_cast<size_t>(at)] = static_cast<uint16_t>(rows[static_cast<size_t>(at)] | row);
    }
}

/// Adds the free blocks that touch reached ones to these, also by an edge or a corner. Returns whether there
/// were any.
bool grow(Rows& reached, const Rows& free) {
    bool grown = false;
    for (int z = 0; z < kAlong; ++z)
        for (int y = 0; y < kAlong; ++y) {
            uint32_t about = 0;
            for (int k = std::max(z - 1, 0); k <= std::min(z + 1, kAlong - 1); ++k)
                for (int j = std::max(y - 1, 0); j <= std::min(y + 1, kAlong - 1); ++j)
                    about |= reached[static_cast<size_t>(k * kAlong + j)];
            const auto at = static_cast<size_t>(z * kAlong + y);
            uint32_t row = reached[at] | ((about | about << 1 | about >> 1) & free[at]);
            // Along the row at once.
            for (uint32_t before = 0; before != row;) {
                before = row;
                row |= (row << 1 | row >> 1) & free[at];
            }
            grown = grown || row != reached[at];
            reached[at] = static_cast<uint16_t>(row);
        }
    return grown;
}

}  // namespace

uint64_t blocks_of(const Polygon& part, const glm::ivec3& cell, float radius) {
    int joined = 1;
    while (joined < kBlocksAlong && radius * kRadiiABlock * kBlocksAlong > static_cast<float>(joined))
        joined *= 2;
    if (joined == kBlocksAlong) return kAllBlocks;
    Polygon scaled = part;
    for (size_t i = 0; i < scaled.count; ++i)
        scaled.corners[i] = static_cast<float>(kBlocksAlong / joined) * (part.corners[i] - glm::vec3(cell));
    uint64_t touched = 0;
    for_each_voxel_of(glm::ivec3(kBlocksAlong / joined), scaled, kTouchingBlocks,
                      [&](const glm::ivec3& block, const Polygon&) {
                          for (int i = 0; i < joined * joined * joined; ++i)
                              touched |=
                                  block_bit(joined * block + glm::ivec3(i % joined, i / joined % joined,
                                                                        i / (joined * joined)));
                      });
    return touched;
}

uint64_t free_columns(uint64_t blocks, int axis) {
    constexpr int kStrides[] = {1, kBlocksAlong, kBlocksAlong * kBlocksAlong};
    constexpr uint64_t kFirst[] = {0x1111111111111111u, 0x000f000f000f000fu, 0x000000000000ffffu};
    const int stride = kStrides[axis];
    const uint64_t taken =
        (blocks | blocks >> stride | blocks >> (2 * stride) | blocks >> (3 * stride)) & kFirst[axis];
    const uint64_t free = ~taken & kFirst[axis];
    return free | free << stride | free << (2 * stride) | free << (3 * stride);
}

bool connects_all(const uint64_t (&blocks)[27]) {
    const auto columns = [&](int voxel) {
        return free_columns(blocks[voxel], 0) | free_columns(blocks[voxel], 1) |
               free_columns(blocks[voxel], 2);
    };
    constexpr int kMiddle = 13;
    const uint64_t own = columns(kMiddle);
    if (own == 0) return false;
    Rows free{}, wanted{}, reached{};
    for (int voxel = 0; voxel < 27; ++voxel) {
        put(free, ~blocks[voxel], voxel);
        put(wanted, columns(voxel), voxel);
    }
    put(reached, own & (~own + 1), kMiddle);  // its lowest block
    while (grow(reached, free)) {
    }
    for (size_t i = 0; i < wanted.size(); ++i)
        if ((wanted[i] & ~reached[i]) != 0) return false;
    return true;
}

}  // namespace lucarne::gi::volume
