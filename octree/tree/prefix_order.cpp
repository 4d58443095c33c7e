#include "octree/tree/prefix_order.h"

#include <array>
#include <bit>
#include <cassert>

namespace lucarne::octree {

void append_prefix_order(std::span<const uint8_t> passes, uint8_t from, std::vector<uint32_t>& order) {
    // A counting sort by pass; then each pass is appended in bit-reversed rank.
    std::array<uint32_t, kLastPass + 2> begin{};
    for (const uint8_t pass : passes) {
        assert(pass <= kLastPass);
        ++begin[pass + 1u];
    }
    for (size_t i = 1; i < begin.size(); ++i) begin[i] += begin[i - 1];
    std::vector<uint32_t> sorted(passes.size());
    auto cursor = begin;
    for (uint32_t i = 0; i < passes.size(); ++i) sorted[cursor[passes[i]]++] = i;
    for (size_t pass = from; pass <= kLastPass; ++pass) {
        const uint32_t count = begin[pass + 1] - begin[pass];
        if (count == 0) continue;
        const uint64_t range = std::bit_ceil(count);
        for (uint64_t i = 0, rank = 0; i < range; ++i) {
            if (rank < count) order.push_back(sorted[begin[pass] + rank]);
            uint64_t bit = range >> 1;  // increments the bit-reversed counter: carries run downwards
            for (; rank & bit; bit >>= 1) rank ^= bit;
            rank |= bit;
        }
    }
}

}  // namespace lucarne::octree
