#pragma once

#include <algorithm>
#include <array>
#include <cassert>
#include <cstdint>
#include <utility>
#include <vector>

namespace lucarne::octree {

struct CodeIndex {
    uint64_t code = 0;
    uint32_t index = 0;
};

/// Sorts stably by the lower `bits` bits of the code (the others are equal), least significant digit first.
inline void sort_by_code(std::vector<CodeIndex>& items, uint32_t bits) {
    constexpr uint32_t kDigit = 11;
    if (items.size() < 4096) {  // the passes would cost more than the comparisons
        std::stable_sort(items.begin(), items.end(),
                         [](const auto& a, const auto& b) { return a.code < b.code; });
        return;
    }
    std::vector<CodeIndex> other(items.size());
    std::array<uint32_t, 1 << kDigit> begin;
    for (uint32_t shift = 0; shift < bits; shift += kDigit) {
        const auto digit = [shift](const CodeIndex& item) {
            return item.code >> shift & ((1u << kDigit) - 1);
        };
        begin.fill(0);
        for (const auto& item : items) ++begin[digit(item)];
        uint32_t sum = 0;
        for (auto& b : begin) sum += std::exchange(b, sum);
        for (const auto& item : items) other[begin[digit(item)]++] = item;
        items.swap(other);
    }
    assert(std::ranges::is_sorted(items, {}, &CodeIndex::code));  // fails if the upper bits differed
}

}  // namespace lucarne::octree
