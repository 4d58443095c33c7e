#pragma once

#include <array>
#include <bit>
#include <cstdint>

namespace lucarne::octree::codec {

/// Splits any 64-bit number into a token of one byte for the entropy coder and lower bits that are stored
/// plainly. Numbers below 16 are their own token; above, there are four tokens per octave. After: Alakuijala
/// et al., "JPEG XL next-generation image compression architecture and coding tools", 2019 (hybrid integers).
constexpr uint32_t kDirect = 16;

constexpr uint32_t token_of(uint64_t value) {
    if (value < kDirect) return static_cast<uint32_t>(value);
    const auto top = static_cast<uint32_t>(63 - std::countl_zero(value));
    return kDirect + (top - 4) * 4 + static_cast<uint32_t>(value >> (top - 2) & 3);
}
constexpr uint32_t extra_bits(uint32_t token) {
    return token < kDirect ? 0 : (token - kDirect) / 4 + 2;
}
/// The least value with this token.
constexpr uint64_t token_base(uint32_t token) {
    return token < kDirect ? token : uint64_t{4 + (token - kDirect) % 4} << extra_bits(token);
}

struct TokenTable {
    std::array<uint64_t, 256> base{};
    std::array<uint8_t, 256> bits{};
    constexpr TokenTable() {
        for (uint32_t token = 0; token < 256; ++token) {
            base[token] = token_base(token);
            bits[token] = static_cast<uint8_t>(extra_bits(token));
        }
    }
};
inline constexpr TokenTable kTokens;

/// Maps numbers of small magnitude to small numbers: 0, -1, 1, -2, ... become 0, 1, 2, 3, ...
constexpr uint64_t fold_sign(uint64_t difference) {
    return difference << 1 ^ (0 - (difference >> 63));
}
constexpr uint64_t unfold_sign(uint64_t folded) {
    return folded >> 1 ^ (0 - (folded & 1));
}

}  // namespace lucarne::octree::codec
