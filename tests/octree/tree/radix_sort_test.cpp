#include "octree/tree/radix_sort.h"

#include <algorithm>
#include <random>

#include <gtest/gtest.h>

namespace lucarne::octree {
namespace {

/// Codes of `bits` bits: all different, in a few crowded cells, or few different ones.
std::vector<CodeIndex> codes(size_t count, uint32_t bits, uint32_t crowded_bits) {
    std::mt19937_64 random(count + bits);
    std::vector<CodeIndex> items(count);
    const uint64_t all = (uint64_t{1} << bits) - 1, some = (uint64_t{1} << crowded_bits) - 1;
    for (uint32_t i = 0; i < count; ++i) items[i] = {random() & (i % 4 == 0 ? all : some), i};
    return items;
}

TEST(RadixSort, givesTheOrderOfAStableSort) {
    for (const size_t count : {size_t{0}, size_t{1}, size_t{40}, size_t{5000}, size_t{60000}})
        for (const uint32_t bits : {22u, 33u, 42u, 63u})
            for (const uint32_t crowded_bits : {bits, bits / 2, 3u, 0u}) {
                auto sorted = codes(count, bits, crowded_bits), expected = sorted;
                std::stable_sort(expected.begin(), expected.end(),
                                 [](const auto& a, const auto& b) { return a.code < b.code; });
                sort_by_code(sorted, bits);
                EXPECT_TRUE(std::ranges::equal(
                    sorted, expected,
                    [](const auto& a, const auto& b) { return a.code == b.code && a.index == b.index; }))
                    << count << " items of " << bits << " bits, crowded in " << crowded_bits;
            }
}

}  // namespace
}  // namespace lucarne::octree
