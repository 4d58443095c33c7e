#include "viewer/flythrough/compare_flights.h"

#include <cmath>
#include <fstream>
#include <random>

#include <gmock/gmock.h>

#include "tests/viewer/program.h"

namespace lucarne::viewer {
namespace {

using test::TemporaryFolder;

/// Returns frames along a path whose cost rises and falls, `factor` times as long, with noise; every tenth is
/// disturbed.
FlownReport flown(size_t frames, double factor, uint32_t seed, double first = 0) {
    std::mt19937 random(seed);
    std::normal_distribution<double> noise(0, 0.04);
    FlownReport report;
    report.engine = "direct";
    report.mode = "wait";
    for (size_t i = 0; i < frames; ++i) {
        const double time = first + 0.04 * static_cast<double>(i);
        report.times.push_back(time);
        report.ms.push_back(factor * (30 + 15 * std::sin(time)) * std::exp(noise(random)) * (i % 10 ? 1 : 3));
    }
    return report;
}

TEST(CompareFlights, PairedFramesShowASmallDifferenceWithItsInterval) {
    const auto c = compare_flights(flown(200, 1, 1), flown(200, 1.1, 2), 0.03);
    EXPECT_TRUE(c.paired);
    EXPECT_NEAR(c.ratio, 1.1, 0.02);
    EXPECT_LT(c.low, c.ratio);
    EXPECT_GT(c.high, c.ratio);
    EXPECT_EQ(c.verdict, Verdict::slower);
    EXPECT_EQ(compare_flights(flown(200, 1.1, 2), flown(200, 1, 1), 0.03).verdict, Verdict::faster);
}

TEST(CompareFlights, EqualFlightsAreNotToldApart) {
    int told_apart = 0;
    for (uint32_t seed = 0; seed < 20; ++seed) {
        const auto c = compare_flights(flown(150, 1, seed), flown(150, 1, 100 + seed), 0.03);
        told_apart += c.verdict == Verdict::slower || c.verdict == Verdict::faster;
    }
    EXPECT_EQ(told_apart, 0);
    EXPECT_EQ(compare_flights(flown(400, 1, 1), flown(400, 1, 2), 0.03).verdict, Verdict::same);
}

TEST(CompareFlights, TheIntervalHoldsTheTruthAboutAsOftenAsItSays) {
    int inside = 0;
    for (uint32_t seed = 0; seed < 40; ++seed) {
        const auto c = compare_flights(flown(120, 1, seed), flown(120, 1.2, 1000 + seed), 0.03);
        inside += c.low <= 1.2 && 1.2 <= c.high;
    }
    EXPECT_GE(inside, 34);  // of 40 intervals at 95 %: fewer occur for one in thousands of seeds
}

TEST(CompareFlights, FramesAtOtherTimesAreComparedByRank) {
    const auto a = flown(157, 1, 1), b = flown(140, 2, 2, 0.01);
    const auto c = compare_flights(a, b, 0.03);
    EXPECT_FALSE(c.paired);
    EXPECT_LT(c.p, 1e-3);
    EXPECT_EQ(c.verdict, Verdict::slower);
    EXPECT_THAT(verdict_text(c, a, b), testing::HasSubstr("157 and 140 frames"));
}

TEST(CompareFlights, AFewFramesProveNothing) {
    EXPECT_EQ(compare_flights(flown(1, 1, 1), flown(1, 1.01, 1), 0.03).verdict, Verdict::same)
        << "one pair, and within the margin";
    EXPECT_EQ(compare_flights(flown(3, 1, 1), flown(2, 1.2, 2), 0.03).verdict, Verdict::unclear);
}

TEST(CompareFlights, ReportsAreCheckedAsTheyAreRead) {
    const TemporaryFolder folder;
    const auto read = [&](const std::string& text) {
        std::ofstream(folder / "r.json") << text;
        return read_flights(folder / "r.json");
    };
    const std::string head = R"({"engine": "vpl", "mode": "wait", "preset": "high", "each_frame": )";
    const auto one = read(head + R"([{"time": 0, "ms": 3, "more": 1}]})");
    ASSERT_TRUE(one) << one.error().line();
    EXPECT_EQ(one->at(0).name(), "vpl, wait");
    const auto two =
        read(R"({"flights": [)" + head + R"([{"time": 0, "ms": 3}], "start": {"cold": true}}]})");
    ASSERT_TRUE(two) << two.error().line();
    EXPECT_EQ(two->at(0).name(), "vpl, cold, wait");
    for (const std::string bad : {"", "[]", "{}", R"({"flights": []})", R"({"flights": 3})"}) {
        const auto refused = read(bad);
        ASSERT_FALSE(refused) << bad;
        EXPECT_EQ(refused.error().kind, ErrorKind::input_rejected);
    }
    for (const std::string frames :
         {"[]}", "[3]}", R"([{"time": 0}]})", R"([{"time": 0, "ms": -1}]})", R"([{"time": 0, "ms": "x"}]})"})
        EXPECT_FALSE(read(head + frames)) << frames;
}

}  // namespace
}  // namespace lucarne::viewer
