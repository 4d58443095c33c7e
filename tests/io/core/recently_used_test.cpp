#include "io/core/recently_used.h"

#include <gtest/gtest.h>

#include "io/core/quantile.h"

namespace lucarne {
namespace {

TEST(RecentlyUsed, TheValueThatWasNotAskedForTheLongestGoesFirst) {
    RecentlyUsed<int, char> kept;
    EXPECT_EQ(kept.find(1), nullptr);
    kept.add(1, 'a');
    kept.add(2, 'b');
    kept.add(3, 'c');
    ASSERT_NE(kept.find(1), nullptr);
    EXPECT_EQ(*kept.find(1), 'a');
    EXPECT_EQ(kept.take_oldest(), 'b');
    EXPECT_EQ(kept.take(3), 'c');
    EXPECT_EQ(kept.take(3), std::nullopt);
    EXPECT_EQ(kept.find(2), nullptr);
    EXPECT_EQ(kept.size(), 1u);
    EXPECT_EQ(kept.take_oldest(), 'a');
    EXPECT_EQ(kept.size(), 0u);
}

TEST(Quantile, TheNearestRankIsOneOfTheValues) {
    std::array<double, 5> values = {4, 1, 5, 3, 2};
    EXPECT_EQ(nearest_rank(values, 0), 1);
    EXPECT_EQ(nearest_rank(values, .2), 1);
    EXPECT_EQ(nearest_rank(values, .21), 2);
    EXPECT_EQ(nearest_rank(values, .5), 3);
    EXPECT_EQ(nearest_rank(values, 1), 5);
    EXPECT_EQ(nearest_rank({}, .5), 0);
}

}  // namespace
}  // namespace lucarne
