#pragma once

#include <algorithm>
#include <array>
#include <cassert>
#include <cstddef>
#include <cstdint>
#include <span>
#include <utility>
#include <vector>

namespace lucarne::octree {

struct CodeIndex {
    uint64_t code = 0;
    uint32_t index = 0;
};

/// Sorts stably by insertion: for a few items.
inline void insert_in_order(std::span<CodeIndex> items) {
    for (size_t i = 1; i < items.size(); ++i) {
        const CodeIndex item = items[i];
        size_t at = i;
        for (; at > 0 && items[at - 1].code > item.code; --at) items[at] = items[at - 1];
        items[at] = item;
    }
}

/// Sorts stably by the lower `bits` bits of the code (the others are equal); `other` is scratch memory of the
/// same size. The upper kPasses digits are sorted by counting, least significant digit first. They
/// distinguish nearly all points of a chunk, so the runs of equal digits that remain are sorted by
/// themselves, which is cheaper than more passes over all.
inline void sort_by_code(std::span<CodeIndex> items, std::span<CodeIndex> other, uint32_t bits) {
    constexpr uint32_t kDigit = 11, kPasses = 3;
    constexpr size_t kFew = 32, kMany = 4096;
    if (items.size() <= kFew) return insert_in_order(items);
    if (items.size() < kMany) {  // the passes would cost more than the comparisons
        std::stable_sort(items.begin(), items.end(),
                         [](const auto& a, const auto& b) { return a.code < b.code; });
        return;
    }
    const uint32_t lower = bits > kPasses * kDigit ? bits - kPasses * kDigit : 0;
    std::array<uint32_t, 1 << kDigit> begin;
    auto from = items, to = other;
    for (uint32_t shift = lower; shift < bits; shift += kDigit) {
        const auto digit = [shift](const CodeIndex& item) {
            return item.code >> shift & ((1u << kDigit) - 1);
        };
        begin.fill(0);
        for (const auto& item : from) ++begin[digit(item)];
        uint32_t sum = 0;
        for (auto& b : begin) sum += std::exchange(b, sum);
        for (const auto& item : from) to[begin[digit(item)]++] = item;
        std::swap(from, to);
    }
    if (from.data() != items.data()) std::copy(from.begin(), from.end(), items.begin());
    for (size_t first = 0, last; lower > 0 && first < items.size(); first = last) {
        const uint64_t upper = items[first].code >> lower;
        for (last = first + 1; last < items.size() && items[last].code >> lower == upper;) ++last;
        sort_by_code(items.subspan(first, last - first), other.subspan(first, last - first), lower);
    }
}

inline void sort_by_code(std::vector<CodeIndex>& items, uint32_t bits) {
    std::vector<CodeIndex> other(items.size());
    sort_by_code(items, other, bits);
    assert(std::ranges::is_sorted(items, {}, &CodeIndex::code));  // fails if the upper bits differed
}

}  // namespace lucarne::octree
