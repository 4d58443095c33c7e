#include "gi/volume/blocks.h"

#include <algorithm>
#include <array>
#include <bit>
#include <cmath>
#include <cstddef>
#include <cstdlib>
#include <vector>

#include <glm/common.hpp>

#include "gi/shared/brdf.h"
#include "gi/volume/disc_areas.h"

namespace lucarne::gi::volume {
namespace {

constexpr int kAlong = 3 * kBlocksAlong;
constexpr int kMiddle = 13;  ///< of the voxels
using Rows = BlockRows;
constexpr uint64_t kRowBits = 0x0fff0fff0fff0fff;

/// Sets the bits of a mask's voxel in rows.
void put(Rows& rows, uint64_t mask, int voxel) {
    const int x = voxel % 3 * kBlocksAlong, y = voxel / 3 % 3, z = voxel / 9 * kBlocksAlong;
    for (int k = 0; k < kBlocksAlong; ++k) {
        const uint64_t layer = mask >> (16 * k);
        const uint64_t spread =
            (layer & 0xf) | (layer & 0xf0) << 12 | (layer & 0xf00) << 24 | (layer & 0xf000) << 36;
        rows[static_cast<size_t>((z + k) * 3 + y)] |= spread << x;
    }
}

/// Returns the mask of the middle voxel.
uint64_t middle_of(const Rows& rows) {
    uint64_t mask = 0;
    for (int k = 0; k < kBlocksAlong; ++k) {
        const uint64_t own = rows[static_cast<size_t>((kBlocksAlong + k) * 3 + 1)] >> kBlocksAlong;
        const uint64_t layer = (own & 0xf) | (own >> 12 & 0xf0) | (own >> 24 & 0xf00) | (own >> 36 & 0xf000);
        mask |= layer << (16 * k);
    }
    return mask;
}

/// Returns the rows that lie `k` rows (-4 to 4, not 0) along y from those of a word, in a layer of three.
uint64_t along_y(const uint64_t* layer, int word, int k) {
    const int next = k > 0 ? word + 1 : word - 1, bits = 16 * std::abs(k);
    const uint64_t beyond = next >= 0 && next < 3 ? layer[next] : 0;
    if (bits == 64) return beyond;
    return k > 0 ? layer[word] >> bits | beyond << (64 - bits) : layer[word] << bits | beyond >> (64 - bits);
}

/// Sets `touched` to the blocks of a layer along z that touch others, also by an edge or a corner, and to
/// those of them in it.
void touched_in_layer(const Rows& others, int z, uint64_t (&touched)[3]) {
    uint64_t about[3] = {};
    for (int k = std::max(z - 1, 0); k <= std::min(z + 1, kAlong - 1); ++k)
        for (int i = 0; i < 3; ++i) about[i] |= others[static_cast<size_t>(3 * k + i)];
    for (int i = 0; i < 3; ++i) {
        const uint64_t rows = about[i] | along_y(about, i, 1) | along_y(about, i, -1);
        touched[i] = (rows | rows << 1 | rows >> 1) & kRowBits;
    }
}

/// Adds the free blocks that touch reached ones to these. Returns whether there were any.
bool grow(Rows& reached, const Rows& free) {
    bool grown = false;
    const auto grow_layer = [&](int z) {
        uint64_t touched[3];
        touched_in_layer(reached, z, touched);
        for (int i = 0; i < 3; ++i) {
            const auto at = static_cast<size_t>(3 * z + i);
            uint64_t rows = reached[at] | (touched[i] & free[at]);
            // Along the rows at once.
            for (uint64_t before = 0; before != rows;) {
                before = rows;
                rows |= (rows << 1 | rows >> 1) & free[at];
            }
            grown = grown || rows != reached[at];
            reached[at] = rows;
        }
    };
    for (int z = 0; z < kAlong; ++z) grow_layer(z);
    for (int z = kAlong - 1; z-- > 0;) grow_layer(z);
    return grown;
}

/// Joins each row with those up to `count` - 1 rows after it (`step` 1) or before it (-1): along y, then z.
template <class Join>
void join_rows(Rows& rows, int count, int step, const Join& join) {
    const Rows before = rows;
    for (int at = 0; at < 3 * kAlong; ++at)
        for (int k = 1; k < count; ++k)
            join(rows[static_cast<size_t>(at)],
                 along_y(before.data() + static_cast<ptrdiff_t>(at / 3) * 3, at % 3, k * step));
    for (int n = 0; n < 3 * kAlong; ++n) {
        const int at = step > 0 ? n : 3 * kAlong - 1 - n;
        for (int k = 1; k < count; ++k) {
            const int other = at + 3 * k * step;
            const bool inside = other >= 0 && other < 3 * kAlong;
            join(rows[static_cast<size_t>(at)], inside ? rows[static_cast<size_t>(other)] : 0);
        }
    }
}

/// Returns the free cubes of `side` blocks along each axis, by their lowest blocks.
Rows free_cubes(const Rows& free, int side) {
    Rows cubes = free;
    for (int k = 1; k < side; ++k)
        for (size_t i = 0; i < free.size(); ++i) cubes[i] &= free[i] >> k;
    join_rows(cubes, side, 1, [](uint64_t& a, uint64_t b) { a &= b; });
    return cubes;
}

/// Returns all blocks of such cubes.
Rows all_of_cubes(const Rows& cubes, int side) {
    Rows all = cubes;
    for (int k = 1; k < side; ++k)
        for (size_t i = 0; i < all.size(); ++i) all[i] |= cubes[i] << k;
    join_rows(all, side, -1, [](uint64_t& a, uint64_t b) { a |= b; });
    return all;
}

}  // namespace

uint64_t blocks_in_box(const glm::vec3& low, const glm::vec3& high) {
    const auto layer = [](float place) {
        return static_cast<int>(std::clamp(place, 0.0f, float{kBlocksAlong - 1}));
    };
    uint64_t found = kAllBlocks;
    for (int axis = 0; axis < 3; ++axis)
        found &= block_layers(axis, layer(low[axis] - kTouchingBlocks), layer(high[axis] + kTouchingBlocks));
    return found;
}

uint64_t blocks_touched(uint64_t blocks, const glm::vec3& place, const glm::vec3& normal, float radius) {
    constexpr float kHalf = 0.5f + kTouchingBlocks;
    const glm::vec3 off = glm::abs(normal);
    const float reach = kHalf * (off.x + off.y + off.z);
    const auto from_place = [&](int bit) {
        return glm::vec3(static_cast<float>(bit % 4) + 0.5f, static_cast<float>(bit / 4 % 4) + 0.5f,
                         static_cast<float>(bit / 16) + 0.5f) -
               place;
    };
    uint64_t near = 0;
    for (uint64_t left = blocks; left != 0; left &= left - 1)
        if (std::abs(glm::dot(normal, from_place(std::countr_zero(left)))) <= reach)
            near |= left & (~left + 1);
    if (near == 0) return 0;
    // Two convex bodies are apart if they are along a normal of a face of one (the blocks are in the box), or
    // along a direction across an edge of each (Gottschalk et al. 1996, "OBBTree"). Opposite edges of an
    // octagon are parallel.
    constexpr size_t kEdgeNormals = 12;
    float x[kEdgeNormals], y[kEdgeNormals], z[kEdgeNormals], most[kEdgeNormals];
    const Octagon octagon(normal, radius);
    const glm::vec3 u = octagon.u, v = octagon.v;
    size_t k = 0;
    for (const glm::vec3& edge : {u, v, u + v, u - v})
        for (const glm::vec3& across :
             {glm::vec3(0, edge.z, -edge.y), glm::vec3(-edge.z, 0, edge.x), glm::vec3(edge.y, -edge.x, 0)}) {
            x[k] = across.x, y[k] = across.y, z[k] = across.z;
            most[k++] = octagon.reach(across) +
                        kHalf * (std::abs(across.x) + std::abs(across.y) + std::abs(across.z));
        }
    uint64_t found = 0;
    for (; near != 0; near &= near - 1) {
        const glm::vec3 way = from_place(std::countr_zero(near));
        int apart = 0;
        for (size_t i = 0; i < kEdgeNormals; ++i)
            apart |= std::abs(x[i] * way.x + y[i] * way.y + z[i] * way.z) > most[i];
        if (!apart) found |= near & (~near + 1);
    }
    return found;
}

int gap_between(float radius, float area) {
    // A square of `a` radii along each side is free of discs at random places if no middle is in the square,
    // beside it or at its corners: (a^2 + 4 a + pi) radius^2. In that area lie kRarity middles.
    const float along = std::sqrt(std::max((4 - kPi) * radius * radius + kRarity * area, 0.0f)) - 2 * radius;
    const float blocks = std::ceil(along * kBlocksAlong);
    return static_cast<int>(std::clamp(blocks, 1.0f, float{kWidestGap + 1}));
}

uint64_t without_gaps(const std::array<uint64_t, 27>& blocks, int gap) {
    if (gap <= 1) return blocks[kMiddle];
    Rows free{};
    for (int voxel = 0; voxel < 27; ++voxel) put(free, ~blocks[static_cast<size_t>(voxel)], voxel);
    // Parts of what is free, of cubes that a cube reaches from one to the other.
    std::vector<Rows> parts;
    for (Rows cubes = free_cubes(free, gap);;) {
        const auto first = std::ranges::find_if(cubes, [](uint64_t rows) { return rows != 0; });
        if (first == cubes.end()) break;
        Rows part{};
        part[static_cast<size_t>(first - cubes.begin())] = *first & (~*first + 1);  // one of them
        while (grow(part, cubes)) {
        }
        for (size_t i = 0; i < cubes.size(); ++i) cubes[i] &= ~part[i];
        parts.push_back(all_of_cubes(part, gap));
    }
    uint64_t kept = 0;
    for (const Rows& part : parts) {
        Rows others{}, about{};
        for (const Rows& other : parts)
            for (size_t i = 0; &other != &part && i < others.size(); ++i) others[i] |= other[i];
        for (int z = kBlocksAlong; z < 2 * kBlocksAlong; ++z) {
            uint64_t touched[3];
            touched_in_layer(others, z, touched);
            for (int i = 0; i < 3; ++i) about[static_cast<size_t>(3 * z + i)] = touched[i];
        }
        kept |= middle_of(part) & ~middle_of(about);
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

namespace {

Rows free_rows(const std::array<uint64_t, 27>& blocks) {
    Rows free{};
    for (int i = 0; i < 27; ++i) put(free, ~blocks[static_cast<size_t>(i)], i);
    return free;
}

/// Returns the free blocks that are connected with those of a mask's voxel.
Rows grown(const Rows& free, uint64_t mask, int voxel) {
    Rows reached{};
    put(reached, mask, voxel);
    while (grow(reached, free)) {
    }
    return reached;
}

}  // namespace

AirAbout air_about(const std::array<uint64_t, 27>& blocks, uint32_t air) {
    const Rows free = free_rows(blocks);
    const auto first = std::ranges::find_if(blocks, [](uint64_t b) { return b != kAllBlocks; });
    if (first == blocks.end()) return {};
    const int seed = air != 0 ? std::countr_zero(air) : static_cast<int>(first - blocks.begin());
    const uint64_t own = ~blocks[static_cast<size_t>(seed)];
    const Rows reached = grown(free, own & (~own + 1), seed);  // from one block: there may be a wall between
    Rows apart{}, wanted = free;
    if (air != 0) {
        wanted = {};
        for (int i = 0; i < 27; ++i)
            if ((air >> i & 1) != 0) put(wanted, kAllBlocks, i);
    }
    AirAbout found{.one = true, .reached = middle_of(reached)};
    for (size_t i = 0; i < free.size(); ++i) {
        apart[i] = free[i] & ~reached[i];
        found.one = found.one && (wanted[i] & ~reached[i]) == 0;
    }
    Rows touching{};
    for (int z = kBlocksAlong; z < 2 * kBlocksAlong; ++z) {
        uint64_t touched[3];
        touched_in_layer(apart, z, touched);
        for (int i = 0; i < 3; ++i) touching[static_cast<size_t>(3 * z + i)] = touched[i];
    }
    found.apart = middle_of(touching);
    return found;
}

bool connects(const std::array<uint64_t, 27>& blocks, const std::array<uint64_t, 27>& wanted) {
    const uint64_t own = wanted[kMiddle];
    if (own == 0) return false;
    const Rows reached = grown(free_rows(blocks), own & (~own + 1), kMiddle);  // from its lowest block
    Rows all{};
    for (int i = 0; i < 27; ++i) put(all, wanted[static_cast<size_t>(i)], i);
    for (size_t i = 0; i < all.size(); ++i)
        if ((all[i] & ~reached[i]) != 0) return false;
    return true;
}

BlockRows connected_with(const std::array<uint64_t, 27>& blocks, int voxel) {
    return grown(free_rows(blocks), ~blocks[static_cast<size_t>(voxel)], voxel);
}

bool holds(const BlockRows& rows, const glm::ivec3& block) {
    for (int axis = 0; axis < 3; ++axis)
        if (block[axis] < 0 || block[axis] >= kAlong) return false;
    const int row = block.y % kBlocksAlong;
    return (rows[static_cast<size_t>(3 * block.z + block.y / kBlocksAlong)] >> (16 * row + block.x) & 1) != 0;
}

}  // namespace lucarne::gi::volume
