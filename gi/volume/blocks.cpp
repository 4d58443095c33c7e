#include "gi/volume/blocks.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <vector>

#include <glm/common.hpp>

#include "gi/shared/brdf.h"
#include "gi/volume/disc_areas.h"

namespace lucarne::gi::volume {
namespace {

/// Of squares as large as gaps are taken to be, one in e to this power is free by chance.
constexpr float kRarity = 16;
/// What touches a voxel may lie this far outside of it, and touches a block then, too.
constexpr float kTouchingBlocks = 1.25f * kBlocksAlong * kTouching;

constexpr int kAlong = 3 * kBlocksAlong;
constexpr int kMiddle = 13;  ///< of the voxels
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

/// Returns the blocks of a row that touch others, also by an edge or a corner, and those of them in it.
uint32_t touched_in_row(const Rows& others, int y, int z) {
    uint32_t about = 0;
    for (int k = std::max(z - 1, 0); k <= std::min(z + 1, kAlong - 1); ++k)
        for (int j = std::max(y - 1, 0); j <= std::min(y + 1, kAlong - 1); ++j)
            about |= others[static_cast<size_t>(k * kAlong + j)];
    return about | about << 1 | about >> 1;
}

/// Adds the free blocks that touch reached ones to these. Returns whether there were any.
bool grow(Rows& reached, const Rows& free) {
    bool grown = false;
    for (int z = 0; z < kAlong; ++z)
        for (int y = 0; y < kAlong; ++y) {
            const auto at = static_cast<size_t>(z * kAlong + y);
            uint32_t row = reached[at] | (touched_in_row(reached, y, z) & free[at]);
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

/// Joins each row with those up to `count` - 1 rows after it (`step` 1) or before it (-1): along y, then z.
template <class Join>
void join_rows(Rows& rows, int count, int step, const Join& join) {
    for (const int stride : {1, kAlong})
        for (int n = 0; n < kAlong * kAlong; ++n) {
            const int at = step > 0 ? n : kAlong * kAlong - 1 - n, place = at / stride % kAlong;
            uint16_t& row = rows[static_cast<size_t>(at)];
            for (int k = 1; k < count; ++k) {
                const bool inside = place + k * step >= 0 && place + k * step < kAlong;
                row = join(row, inside ? rows[static_cast<size_t>(at + k * step * stride)] : uint16_t{0});
            }
        }
}

/// Returns the free cubes of `side` blocks along each axis, by their lowest blocks.
Rows free_cubes(const Rows& free, int side) {
    Rows cubes = free;
    for (int k = 1; k < side; ++k)
        for (size_t i = 0; i < free.size(); ++i) cubes[i] &= static_cast<uint16_t>(free[i] >> k);
    join_rows(cubes, side, 1, [](uint16_t a, uint16_t b) { return static_cast<uint16_t>(a & b); });
    return cubes;
}

/// Returns all blocks of such cubes.
Rows all_of_cubes(const Rows& cubes, int side) {
    Rows all = cubes;
    for (int k = 1; k < side; ++k)
        for (size_t i = 0; i < all.size(); ++i) all[i] |= static_cast<uint16_t>(cubes[i] << k);
    join_rows(all, side, -1, [](uint16_t a, uint16_t b) { return static_cast<uint16_t>(a | b); });
    return all;
}

/// Returns the mask of the middle voxel, of rows that row(y, z) returns.
template <class Row>
uint64_t middle_of(const Row& row) {
    uint64_t mask = 0;
    for (int i = 0; i < kBlocksAlong * kBlocksAlong; ++i) {
        const uint32_t own = row(kBlocksAlong + i % kBlocksAlong, kBlocksAlong + i / kBlocksAlong);
        mask |= uint64_t{own >> kBlocksAlong & 15u} << (kBlocksAlong * i);
    }
    return mask;
}

}  // namespace

uint64_t blocks_of(const Polygon& part, const glm::ivec3& cell) {
    Polygon scaled = part;
    for (size_t i = 0; i < scaled.count; ++i)
        scaled.corners[i] = static_cast<float>(kBlocksAlong) * (part.corners[i] - glm::vec3(cell));
    uint64_t touched = 0;
    for_each_voxel_of(glm::ivec3(kBlocksAlong), scaled, kTouchingBlocks,
                      [&](const glm::ivec3& block, const Polygon&) { touched |= block_bit(block); });
    return touched;
}

int gap_between(float radius, float area) {
    // A square of `a` radii along each side is free of discs at random places if no middle is in the square,
    // beside it or at its corners: (a^2 + 4 a + pi) radius^2. In that area lie kRarity middles.
    const float coverage = kPi * radius * radius / area;
    const float radii = std::sqrt(std::max(4 - kPi + kRarity * kPi / coverage, 0.0f)) - 2;
    const float blocks = std::ceil(radius * radii * kBlocksAlong);
    return static_cast<int>(std::clamp(blocks, 1.0f, float{kWidestGap + 1}));
}

uint64_t without_gaps(const std::array<uint64_t, 27>& blocks, int gap) {
    if (gap <= 1) return blocks[kMiddle];
    Rows free{};
    for (int voxel = 0; voxel < 27; ++voxel) put(free, ~blocks[static_cast<size_t>(voxel)], voxel);
    // Parts of what is free, of cubes that a cube reaches from one to the other.
    std::vector<Rows> parts;
    for (Rows cubes = free_cubes(free, gap);;) {
        const auto first = std::ranges::find_if(cubes, [](uint16_t row) { return row != 0; });
        if (first == cubes.end()) break;
        Rows part{};
        part[static_cast<size_t>(first - cubes.begin())] = static_cast<uint16_t>(*first & -*first);
        while (grow(part, cubes)) {
        }
        for (size_t i = 0; i < cubes.size(); ++i) cubes[i] &= static_cast<uint16_t>(~part[i]);
        parts.push_back(all_of_cubes(part, gap));
    }
    uint64_t kept = 0;
    for (const Rows& part : parts) {
        Rows others{};
        for (const Rows& other : parts)
            for (size_t i = 0; &other != &part && i < others.size(); ++i) others[i] |= other[i];
        kept |= middle_of([&](int y, int z) {
            return part[static_cast<size_t>(z * kAlong + y)] & ~touched_in_row(others, y, z);
        });
    }
    return ~kept;
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

bool connects_all(const std::array<uint64_t, 27>& blocks) {
    const auto columns = [&](int voxel) {
        const uint64_t own = blocks[static_cast<size_t>(voxel)];
        return free_columns(own, 0) | free_columns(own, 1) | free_columns(own, 2);
    };
    const uint64_t own = columns(kMiddle);
    if (own == 0) return false;
    Rows free{}, wanted{}, reached{};
    for (int voxel = 0; voxel < 27; ++voxel) {
        put(free, ~blocks[static_cast<size_t>(voxel)], voxel);
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
