#pragma once

#include <algorithm>
#include <array>
#include <cmath>
#include <compare>
#include <cstdint>

#include <glm/vec3.hpp>

namespace lucarne::octree {

inline constexpr uint32_t kMaxLevel = 21;  ///< 3 x 21 bits of Morton code fill a 64-bit word
/// Where one cell of kMaxLevel holds more points than a node should, nodes of further levels divide them by
/// their order: their cells are all that one.
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
/// Bit 0 is x, bit 1 y, bit 2 z of the finest level.
constexpr uint64_t morton(uint64_t x, uint64_t y, uint64_t z) {
    return spread_bits(x) | spread_bits(y) << 1 | spread_bits(z) << 2;
}

/// A node's place: its level (0 is the root) and its cell among 2^level per axis.
struct NodeKey {
    uint32_t level = 0, x = 0, y = 0, z = 0;

    /// octant bit 0: upper half in x, bit 1: y, bit 2: z.
    constexpr NodeKey child(uint32_t octant) const {
        return {level + 1, x << 1 | (octant & 1), y << 1 | (octant >> 1 & 1), z << 1 | (octant >> 2 & 1)};
    }
    constexpr NodeKey parent() const { return {level - 1, x >> 1, y >> 1, z >> 1}; }
    constexpr uint32_t octant() const { return (x & 1) | (y & 1) << 1 | (z & 1) << 2; }
    /// Down to kMaxLevel.
    constexpr uint64_t code() const { return morton(x, y, z); }
    /// The node whose cube this one's points lie in: itself down to kMaxLevel.
    constexpr NodeKey cell() const {
        if (level <= kMaxLevel) return *this;
        const uint32_t below = level - kMaxLevel;
        return {kMaxLevel, x >> below, y >> below, z >> below};
    }
    constexpr bool operator==(const NodeKey&) const = default;
    /// By level, then along the Morton curve: the order of a cache's directory, parents before children.
    constexpr std::strong_ordering operator<=>(const NodeKey& other) const {
        if (level != other.level) return level <=> other.level;
        constexpr uint32_t kLow = kMostLevel - kMaxLevel;
        const auto high = [](const NodeKey& k) { return morton(k.x >> kLow, k.y >> kLow, k.z >> kLow); };
        const auto low = [](uint32_t cell) { return cell & ((1u << kLow) - 1); };
        if (const auto order = high(*this) <=> high(other); order != 0) return order;
        return morton(low(x), low(y), low(z)) <=> morton(low(other.x), low(other.y), low(other.z));
    }
};

/// A point's place in the root cube, 32 bits of fixed point an axis: exact enough for sampling, the same for
/// every chunk and level, and the one rule for which node's cube a point is in.
struct Place {
    uint32_t x = 0, y = 0, z = 0;

    constexpr bool operator==(const Place&) const = default;
    /// The Morton code of the place's finest cell.
    constexpr uint64_t code() const {
        constexpr uint32_t kUnused = 32 - kMaxLevel;
        return morton(x >> kUnused, y >> kUnused, z >> kUnused);
    }
    /// The cell of `level` that holds the place.
    constexpr NodeKey key(uint32_t level) const {
        const auto cell = [level](uint32_t v) { return static_cast<uint32_t>(uint64_t{v} >> (32 - level)); };
        return {level, cell(x), cell(y), cell(z)};
    }
};

/// An axis-aligned cube in world coordinates (the file's own unit).
struct Cube {
    glm::dvec3 min{0.0};
    double size = 1.0;
    /// Appending may have doubled the cube, so many times, around a first one, which is now the cell
    /// `first_cell` of that level. Places still count in the first one's lattice, so that rounding moves no
    /// point out of the node it is in.
    uint32_t doublings = 0;
    glm::dvec3 first_min{0.0};
    std::array<uint32_t, 3> first_cell{};

    /// The edge of the cube before it was doubled: what areas are stored relative to.
    double first_size() const { return size / static_cast<double>(uint64_t{1} << doublings); }

    Cube of(const NodeKey& node) const {
        const NodeKey key = node.cell();
        const double part = size / static_cast<double>(uint64_t{1} << key.level);
        return {min + part * glm::dvec3(key.x, key.y, key.z), part};
    }
    /// floor((p - min) * (2^32 / size)) in doubles, clamped to 32 bits (octree/FORMAT.md).
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
