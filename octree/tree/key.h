#pragma once

#include <algorithm>
#include <array>
#include <cmath>
#include <compare>
#include <cstdint>

#include <glm/vec3.hpp>

namespace lucarne::octree {

inline constexpr uint32_t kMaxLevel = 21;  ///< 3 x 21 bits of Morton code fill a 64-bit word
/// The deepest level of any node. Where one cell of kMaxLevel holds more points than a node should, nodes of
/// levels above kMaxLevel divide them by their order. The cube of all these nodes is that one cell.
inline constexpr uint32_t kMostLevel = 31;

/// Spreads the lower 21 bits of `v` to every third bit.
constexpr uint64_t spread_bits(uint64_t v) {
    v &= 0x1fffff;
    v = (v | v << 32) & 0x1f00000000ffffull;
    v = (v | v << 16) & 0x1f0000ff0000ffull;
    v = (v | v << 8) & 0x100f00f00f00f00full;
    v = (v | v << 4) & 0x10c30c30c30c30c3ull;
    v = (v | v << 2) & 0x1249249249249249ull;
    return v;
}
/// Interleaves the bits: bit 0 is the finest level's x, bit 1 its y, bit 2 its z.
constexpr uint64_t morton(uint64_t x, uint64_t y, uint64_t z) {
    return spread_bits(x) | spread_bits(y) << 1 | spread_bits(z) << 2;
}

/// A node's position in the tree: its level (0 is the root) and its cell among 2^level per axis.
struct NodeKey {
    uint32_t level = 0, x = 0, y = 0, z = 0;

    /// Octant bit 0: upper half in x, bit 1: y, bit 2: z.
    constexpr NodeKey child(uint32_t octant) const {
        return {level + 1, x << 1 | (octant & 1), y << 1 | (octant >> 1 & 1), z << 1 | (octant >> 2 & 1)};
    }
    constexpr NodeKey parent() const { return {level - 1, x >> 1, y >> 1, z >> 1}; }
    constexpr uint32_t octant() const { return (x & 1) | (y & 1) << 1 | (z & 1) << 2; }
    /// The Morton code of the cell; only for levels up to kMaxLevel.
    constexpr uint64_t code() const { return morton(x, y, z); }
    /// The node whose cube contains this node's points: itself up to kMaxLevel, else its ancestor of
    /// kMaxLevel.
    constexpr NodeKey cell() const {
        if (level <= kMaxLevel) return *this;
        const uint32_t below = level - kMaxLevel;
        return {kMaxLevel, x >> below, y >> below, z >> below};
    }
    constexpr bool operator==(const NodeKey&) const = default;
    /// Orders by level, then along the Morton curve, as a cache's directory does: parents before children.
    constexpr std::strong_ordering operator<=>(const NodeKey& other) const {
        if (level != other.level) return level <=> other.level;
        constexpr uint32_t kLow = kMostLevel - kMaxLevel;
        const auto high = [](const NodeKey& k) { return morton(k.x >> kLow, k.y >> kLow, k.z >> kLow); };
        const auto low = [](uint32_t cell) { return cell & ((1u << kLow) - 1); };
        if (const auto order = high(*this) <=> high(other); order != 0) return order;
        return morton(low(x), low(y), low(z)) <=> morton(low(other.x), low(other.y), low(other.z));
    }
};

/// A point's position in the root cube, 32 bits of fixed point per axis. It is exact enough for sampling, the
/// same for every chunk and level, and alone decides in which node's cube a point is.
struct Place {
    uint32_t x = 0, y = 0, z = 0;

    constexpr bool operator==(const Place&) const = default;
    /// The Morton code of the cell of kMaxLevel that contains the place.
    constexpr uint64_t code() const {
        constexpr uint32_t kUnused = 32 - kMaxLevel;
        return morton(x >> kUnused, y >> kUnused, z >> kUnused);
    }
    /// The cell of `level` that contains the place.
    constexpr NodeKey key(uint32_t level) const {
        const auto cell = [level](uint32_t v) { return static_cast<uint32_t>(uint64_t{v} >> (32 - level)); };
        return {level, cell(x), cell(y), cell(z)};
    }
};

/// An axis-aligned cube in world coordinates (the file's own unit).
struct Cube {
    glm::dvec3 min{0.0};
    double size = 1.0;
    /// How often appending doubled the cube around its first one. The first cube is now the cell `first_cell`
    /// of level `doublings`. Places are still computed in its lattice, so that rounding moves no point into
    /// another node.
    uint32_t doublings = 0;
    glm::dvec3 first_min{0.0};
    std::array<uint32_t, 3> first_cell{};

    /// The edge of the cube before it was doubled; stored areas are relative to it.
    double first_size() const { return size / static_cast<double>(uint64_t{1} << doublings); }

    Cube of(const NodeKey& node) const {
        const NodeKey key = node.cell();
        const double part = size / static_cast<double>(uint64_t{1} << key.level);
        return {min + part * glm::dvec3(key.x, key.y, key.z), part};
    }
    /// Computes floor((p - min) * (2^32 / size)) in doubles, clamped to 32 bits (octree/FORMAT.md).
    Place place(const glm::dvec3& p) const {
        if (doublings) return grown_place(p);
        const double scale = 0x1p32 / size;
        const auto axis = [scale](double v) {
            return static_cast<uint32_t>(std::clamp(v * scale, 0.0, 0x1.fffffffep31));
        };
        return {axis(p.x - min.x), axis(p.y - min.y), axis(p.z - min.z)};
    }
    Place grown_place(const glm::dvec3& p) const {
        const double scale = 0x1p32 / first_size();
        const auto axis = [&](double v, uint32_t cell) {
            const auto q = static_cast<int64_t>(std::clamp(std::floor(v * scale), -0x1p60, 0x1p60));
            return static_cast<uint32_t>(
                std::clamp<int64_t>((q + (int64_t{cell} << 32)) >> doublings, 0, UINT32_MAX));
        };
        return {axis(p.x - first_min.x, first_cell[0]), axis(p.y - first_min.y, first_cell[1]),
                axis(p.z - first_min.z, first_cell[2])};
    }
};

}  // namespace lucarne::octree
