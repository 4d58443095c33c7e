#pragma once

#include <compare>
#include <cstdint>
#include <glm/vec3.hpp>

namespace lucarne::octree {

inline constexpr uint32_t kMaxLevel = 21;  ///< 3 x 21 bits of Morton code fill a 64-bit word

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
    constexpr uint64_t code() const { return morton(x, y, z); }
    constexpr bool operator==(const NodeKey&) const = default;
    /// By level, then along the Morton curve: the order of a cache's directory, parents before children.
    constexpr std::strong_ordering operator<=>(const NodeKey& other) const {
        if (level != other.level) return level <=> other.level;
        return code() <=> other.code();
    }
};

/// An axis-aligned cube in world coordinates (the file's own unit).
struct Cube {
    glm::dvec3 min{0.0};
    double size = 1.0;

    Cube of(const NodeKey& key) const {
        const double part = size / static_cast<double>(uint64_t{1} << key.level);
        return {min + part * glm::dvec3(key.x, key.y, key.z), part};
    }
};

}  // namespace lucarne::octree
