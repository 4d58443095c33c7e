#include <gmock/gmock.h>
#include <nlohmann/json.hpp>

#include "tests/viewer/program.h"

namespace lucarne {
namespace {

using test::bytes_of;
using test::Outcome;
using test::TemporaryFolder;
using testing::HasSubstr;

constexpr const char* kPath = R"({"frames_per_second": 2, "keys": [
    {"time": 0, "position": [2.7, 0.4, 2.7], "target": [2.7, 5, 2.4]},
    {"time": 1, "position": [1.5, 0.8, 3.5], "target": [3, 4, 1.5]}]})";

void write(const std::string& path, const std::string& text) {
    std::ofstream(path) << text;
}

TEST(Fly, WaitingGivesTheSamePicturesOnEveryRunAndAReport) {
    const TemporaryFolder folder;
    const std::string cache = make_cornell(folder);
    write(folder / "path.json", kPath);
    for (const std::string run : {"a", "b"}) {
        const Outcome flown =
            test::lucarne("fly " + cache + " --path " + (folder / "path.json") + " --wait --size 64x48" +
                          " --frames-dir " + (folder / run) + " -o " + (folder / (run + ".json")));
        ASSERT_EQ(flown.code, 0) << flown.output;
    }
    for (int frame = 1; frame <= 3; ++frame) {
        const std::string name = "frame_0000" + std::to_string(frame) + ".png";
        const std::string first = bytes_of(folder.path() / "a" / name);
        ASSERT_GT(first.size(), 500u) << name << " is missing or blank";
        EXPECT_EQ(first, bytes_of(folder.path() / "b" / name)) << name;
    }
    EXPECT_NE(bytes_of(folder.path() / "a/frame_00001.png"), bytes_of(folder.path() / "a/frame_00003.png"));
    EXPECT_FALSE(std::filesystem::exists(folder.path() / "a/frame_00004.png"));

    const auto report = nlohmann::json::parse(bytes_of(folder / "a.json"));
    EXPECT_EQ(report["frames"], 3);
    EXPECT_EQ(report["mode"], "wait");
    EXPECT_EQ(report["preset"], "interactive");
    EXPECT_EQ(report["complete"]["least"], 1.0);
    EXPECT_GT(report["frame_ms"]["p50"].get<double>(), 0);
    EXPECT_LE(report["frame_ms"]["p50"].get<double>(), report["frame_ms"]["p99"].get<double>());
    EXPECT_GT(report["passes_ms"]["G-buffer"]["mean"].get<double>(), 0);
    EXPECT_GT(report["points_per_frame"]["view"]["mean"].get<double>(), 1000);
    EXPECT_GT(report["bytes_loaded"].get<double>(), 0);
    EXPECT_FALSE(report["device"]["renderer"].get<std::string>().empty());
}

TEST(Fly, ByTheClockEndsWithThePathAndNeverWaits) {
    const TemporaryFolder folder;
    const std::string cache = make_cornell(folder);
    write(folder / "path.json", kPath);
    const Outcome flown =
        test::lucarne("fly " + cache + " --path " + (folder / "path.json") + " --realtime --size 64x48" +
                      " --engine direct -o " + (folder / "report.json"));
    ASSERT_EQ(flown.code, 0) << flown.output;
    const auto report = nlohmann::json::parse(bytes_of(folder / "report.json"));
    EXPECT_EQ(report["mode"], "realtime");
    ASSERT_GE(report["each_frame"].size(), 1u);
    double before = -1;
    for (const auto& frame : report["each_frame"]) {
        EXPECT_GT(frame["time"].get<double>(), before);
        before = frame["time"];
        EXPECT_GE(frame["complete"].get<double>(), 0.0);
        EXPECT_LE(frame["complete"].get<double>(), 1.0);
    }
    EXPECT_EQ(before, 1.0) << "the last frame is the path's end";
}

TEST(Fly, WhatFramesTakeOverFromEachOtherLowersTheFlickerAndKeepsTheLight) {
    const TemporaryFolder folder;
    const std::string cache = make_cornell(folder);
    write(folder / "path.json", R"({"frames_per_second": 10, "keys": [
        {"time": 0, "position": [2.7, 0.4, 2.7], "target": [2.7, 5, 2.4]},
        {"time": 1.5, "position": [2.5, 0.6, 2.8], "target": [2.8, 5, 2.3]}]})");
    const auto report = [&](const std::string& name, const std::string& arguments) {
        const Outcome flown =
            test::lucarne("fly " + cache + " --path " + (folder / "path.json") + " --flicker --size 96x72" +
                          " --scene " + LUCARNE_SOURCE_DIR + "/data/scenes/cornell.json --only-bounce 1 " +
                          arguments + " -o " + (folder / name));
        EXPECT_EQ(flown.code, 0) << flown.output;
        return nlohmann::json::parse(bytes_of(folder / name));
    };
    const auto alone = report("alone.json", "--no-reuse"), together = report("together.json", "");
    const double before = alone["flicker"]["mean"], after = together["flicker"]["mean"];
    const double light = alone["luminance"]["mean"], kept = together["luminance"]["mean"];
    std::printf("flicker %.4f each by itself, %.4f together; light %+.2f %%\n", before, after,
                100 * (kept / light - 1));
    EXPECT_GT(alone["flicker"]["matched"].get<double>(), 0.9);
    EXPECT_LT(after, 0.7 * before);
    EXPECT_NEAR(kept / light, 1, 0.01);
}

TEST(Fly, MistakesInThePathAndTheArgumentsAreOneLineAndTheRightCode) {
    const TemporaryFolder folder;
    const std::string cache = folder / "none.luc", path = folder / "path.json",
                      report = folder / "report.json";
    const auto fly = [&](const std::string& more) {
        return test::lucarne("fly " + cache + " --path " + path + " -o " + report + more);
    };
    write(path, R"({"keys": [{"time": 0, "position": [0, 0, 0], "target": [0, 1, 0], "speed": 2}]})");
    Outcome outcome = fly("");
    EXPECT_EQ(outcome.code, 3);
    EXPECT_THAT(outcome.output, HasSubstr("/keys/0/speed: is not a known key"));
    EXPECT_EQ(std::count(outcome.output.begin(), outcome.output.end(), '\n'), 1) << outcome.output;
    write(path, kPath);
    EXPECT_EQ(fly(" --preset fastest").code, 2);
    EXPECT_EQ(fly(" --engine magic").code, 2);
    EXPECT_EQ(fly(" --wait --realtime").code, 2);
    EXPECT_EQ(fly(" --size 0x7").code, 2);
    EXPECT_NE(fly("").code, 0) << "there is no such cache";
    EXPECT_FALSE(std::filesystem::exists(report)) << "nothing half-written is left behind";
    write(report, "{}");
    EXPECT_EQ(fly("").code, 1) << "an output that exists";
    EXPECT_EQ(bytes_of(report), "{}");
}

}  // namespace
}  // namespace lucarne
