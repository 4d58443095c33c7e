#include "viewer/window/health.h"

#include <gtest/gtest.h>

namespace lucarne::viewer {
namespace {

using namespace std::chrono_literals;

TEST(RecoveryTries, AreThreeAMinuteAndComeBackAfterIt) {
    RecoveryTries tries;
    const RecoveryTries::Clock::time_point start{};
    EXPECT_TRUE(tries.take(start));
    EXPECT_TRUE(tries.take(start + 20s));
    EXPECT_TRUE(tries.take(start + 40s));
    EXPECT_FALSE(tries.take(start + 60s));
    EXPECT_TRUE(tries.take(start + 61s)) << "the first was more than a minute ago";
    EXPECT_FALSE(tries.take(start + 70s)) << "those refused do not count, those taken do";
    EXPECT_TRUE(tries.take(start + 81s));
}

TEST(FrameTimes, QuantilesAreOfTheLastFramesAlone) {
    FrameTimes times;
    EXPECT_EQ(times.quantile(0.95), 0);
    for (int i = 0; i < 1000; ++i) times.add(7);
    for (int i = 240; i >= 1; --i) times.add(i);
    EXPECT_EQ(times.frames(), 1240u);
    EXPECT_EQ(times.quantile(0.5), 120);
    EXPECT_EQ(times.quantile(0.95), 228);
    EXPECT_EQ(times.quantile(1), 240);
    EXPECT_EQ(times.quantile(0), 1);
}

}  // namespace
}  // namespace lucarne::viewer
