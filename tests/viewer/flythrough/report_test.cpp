#include "viewer/flythrough/report.h"

#include <gtest/gtest.h>

namespace lucarne::viewer {
namespace {

TEST(Report, QuantilesInterpolateBetweenRanks) {
    EXPECT_EQ(quantile({}, 0.5), 0);
    EXPECT_EQ(quantile({7}, 0.99), 7);
    EXPECT_EQ(quantile({4, 1, 3, 2}, 0.5), 2.5);
    EXPECT_EQ(quantile({4, 1, 3, 2}, 0), 1);
    EXPECT_EQ(quantile({4, 1, 3, 2}, 1), 4);
    std::vector<double> hundred;
    for (int i = 0; i <= 100; ++i) hundred.push_back(100 - i);
    EXPECT_NEAR(quantile(hundred, 0.95), 95, 1e-12);
}

FlownFrame frame(double time, double seconds, std::vector<gi::PassTimes::Pass> passes, uint64_t wanted,
                 uint64_t ready) {
    FlownFrame flown;
    flown.time = time;
    flown.stats.seconds = seconds;
    flown.stats.passes = std::move(passes);
    flown.stats.view_points = ready;
    flown.stats.wanted_points = wanted;
    flown.stats.ready_points = ready;
    flown.stats.bytes_loaded = 1000 + static_cast<uint64_t>(time);
    return flown;
}

TEST(Report, SaysWhatEveryFrameAndPassTookAndHowWholeItWas) {
    const std::vector<FlownFrame> frames = {
        frame(0, 0.010, {{"cuts", 0.001}, {"G-buffer", 0.004}}, 100, 50),
        frame(1, 0.030, {{"cuts", 0.003}, {"upload", 0.002}, {"G-buffer", 0.008}}, 100, 100),
        frame(2, 0.020, {{"cuts", 0.002}, {"G-buffer", 0.006}}, 200, 200),
    };
    FlightConditions conditions;
    conditions.preset = "interactive";
    conditions.mode = "realtime";
    conditions.size = {64, 48};
    const auto report = flight_report(conditions, frames);
    EXPECT_EQ(report["frames"], 3);
    EXPECT_EQ(report["preset"], "interactive");
    EXPECT_NEAR(report["frame_ms"]["p50"].get<double>(), 20, 1e-9);
    EXPECT_NEAR(report["frame_ms"]["max"].get<double>(), 30, 1e-9);
    EXPECT_NEAR(report["passes_ms"]["G-buffer"]["mean"].get<double>(), 6, 1e-9);
    EXPECT_NEAR(report["passes_ms"]["upload"]["mean"].get<double>(), 2.0 / 3, 1e-9)
        << "frames without it took none";
    EXPECT_EQ(report["passes_ms"].begin().key(), "cuts") << "in the order of the frame";
    EXPECT_EQ(report["points_per_frame"]["view"]["max"], 200);
    EXPECT_EQ(report["bytes_loaded"], 1002);
    EXPECT_NEAR(report["complete"]["least"].get<double>(), 0.5, 1e-12);
    EXPECT_NEAR(report["complete"]["mean"].get<double>(), 2.5 / 3, 1e-12);
    EXPECT_EQ(report["complete"]["last"], 1.0);
    EXPECT_EQ(report["each_frame"].size(), 3u);
}

TEST(Report, OfNoFramesIsARecordOfNothing) {
    const auto report = flight_report({}, {});
    EXPECT_EQ(report["frames"], 0);
    EXPECT_EQ(report["frame_ms"]["p99"], 0);
}

}  // namespace
}  // namespace lucarne::viewer
