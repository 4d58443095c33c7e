#include "octree/growing/pass_sample.h"

#include <algorithm>
#include <cstring>
#include <numeric>

#include <gtest/gtest.h>

namespace lucarne::octree {
namespace {

std::vector<uint64_t> numbers_of(std::span<const std::byte> records) {
    std::vector<uint64_t> numbers(records.size() / sizeof(uint64_t));
    if (!numbers.empty()) std::memcpy(numbers.data(), records.data(), records.size());
    return numbers;
}

/// Returns the numbers that are kept of 0, 1, ... count - 1, added in batches.
std::vector<uint64_t> kept_of(uint64_t count, uint64_t most, uint64_t expected, size_t batch = 1000) {
    PassSample sample(sizeof(uint64_t), most, expected);
    std::vector<uint64_t> numbers;
    for (uint64_t i = 0; i < count; ++i) {
        numbers.push_back(i);
        if (numbers.size() < batch && i + 1 < count) continue;
        sample.add(std::as_bytes(std::span(numbers)));
        numbers.clear();
    }
    return numbers_of(sample.take());
}

TEST(PassSample, KeepsAllPointsThatFit) {
    for (const uint64_t expected : {uint64_t{0}, uint64_t{5000}, uint64_t{10}}) {
        const auto kept = kept_of(5000, 5000, expected);
        ASSERT_EQ(kept.size(), 5000u) << expected;
        EXPECT_EQ(kept.back(), 4999u);
    }
    EXPECT_TRUE(kept_of(0, 100, 0).empty());
    EXPECT_TRUE(kept_of(100, 0, 100).empty());
}

TEST(PassSample, KeepsAnEvenShareOfMorePointsWhateverWasExpected) {
    // The last one's header is wrong: far more points come.
    for (const uint64_t expected : {uint64_t{300'000}, uint64_t{0}, uint64_t{20'000}}) {
        const auto kept = kept_of(300'000, 10'000, expected);
        EXPECT_LE(kept.size(), 10'000u);
        EXPECT_GE(kept.size(), expected == 300'000 ? 9'500u : 4'000u);
        EXPECT_TRUE(std::ranges::is_sorted(kept));
        size_t front = 0;
        for (const uint64_t number : kept) front += number < 150'000;
        EXPECT_NEAR(static_cast<double>(front) / static_cast<double>(kept.size()), 0.5, 0.03) << expected;
    }
}

TEST(PassSample, ShowsAShareOfWhatHasComeBeforeAllHasCome) {
    for (const uint64_t expected : {uint64_t{100'000}, uint64_t{0}}) {
        PassSample sample(sizeof(uint64_t), 50'000, expected);
        EXPECT_TRUE(sample.some(10'000).empty());
        std::vector<uint64_t> numbers(25'000), last;
        for (uint64_t quarter = 1; quarter <= 4; ++quarter) {
            std::iota(numbers.begin(), numbers.end(), (quarter - 1) * numbers.size());
            sample.add(std::as_bytes(std::span(numbers)));
            const auto some = numbers_of(sample.some(10'000));
            EXPECT_NEAR(static_cast<double>(some.size()), expected ? 2'500.0 * double(quarter) : 10'000, 400);
            EXPECT_TRUE(std::ranges::is_sorted(some));
            EXPECT_TRUE(expected == 0 || std::ranges::includes(some, last)) << "points come and go";
            last = some;
        }
        EXPECT_GE(numbers_of(sample.some(1'000'000)).size(), 25'000u) << "never more than are kept";
    }
}

TEST(PassSample, DoesNotDependOnBatches) {
    EXPECT_EQ(kept_of(50'000, 3'000, 0, 1), kept_of(50'000, 3'000, 0, 7'777));
}

}  // namespace
}  // namespace lucarne::octree
