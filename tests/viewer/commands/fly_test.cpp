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
        const Outcome flown = test::lucarne("fly " + cache + " --path " + (folder / "path.json") +
                                            " --wait --size 64x48 --bounces 1" + " --frames-dir " +
                                            (folder / run) + " -o " + (folder / (run + ".json")));
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

    std::filesystem::create_directory(folder.path() / "other");
    write(folder / "other/frame_00120.png", "of another flight");
    const Outcome mixed = test::lucarne("fly " + cache + " --path " + (folder / "path.json") +
                                        " --wait --size 64x48 --bounces 1" + " --frames-dir " +
                                        (folder / "other") + " -o " + (folder / "c.json"));
    EXPECT_EQ(mixed.code, 1) << mixed.output;
    EXPECT_FALSE(std::filesystem::exists(folder.path() / "other/frame_00001.png")) << "two flights are mixed";

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

TEST(Fly, NamesOfAnyBytesAreReported) {
    const TemporaryFolder folder;
    const std::string cache = folder / "\xff.luc";
    std::filesystem::rename(make_cornell(folder), cache);
    write(folder / "path.json", kPath);
    const Outcome flown = test::lucarne("fly " + cache + " --path " + (folder / "path.json") +
                                        " --wait --size 64x48 --engine direct" + " -o " +
                                        (folder / "report.json") + " --html " + (folder / "report.html"));
    EXPECT_EQ(flown.code, 0) << flown.output;
    EXPECT_THAT(bytes_of(folder / "report.json"), HasSubstr("\xef\xbf\xbd.luc"));
    const Outcome rendered = test::lucarne("render " + cache + " --size 64x48 --engine direct -o " +
                                           (folder / "\xff.exr") + " --json " + (folder / "render.json"));
    EXPECT_EQ(rendered.code, 0) << rendered.output;
    const Outcome compared = test::lucarne("compare " + (folder / "\xff.exr") + " " + (folder / "\xff.exr") +
                                           " --json " + (folder / "compare.json"));
    EXPECT_EQ(compared.code, 0) << compared.output;
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

TEST(Fly, LampsMoveAndFramesInWhichNothingChangesAreTheSameBits) {
    const TemporaryFolder folder;
    const std::string cache = make_cornell(folder, "20k");
    // The lamp rests for two seconds, goes to the other wall, and gets five times weaker.
    write(folder / "path.json", R"({"frames_per_second": 1, "keys": [
        {"time": 0, "position": [2.7, 0.4, 2.7], "target": [2.7, 5, 2.4]},
        {"time": 4, "position": [2.7, 0.4, 2.7], "target": [2.7, 5, 2.4]}],
        "lights": [{"name": "ceiling lamp", "keys": [
            {"time": 0, "position": [1.3, 2.2, 5.3], "target": [1.3, 2.7, 0], "strength": [170, 145, 110]},
            {"time": 2, "position": [1.3, 2.2, 5.3], "target": [1.3, 2.7, 0]},
            {"time": 3, "position": [4.2, 2.2, 5.3], "target": [4.2, 2.7, 0], "strength": [170, 145, 110]},
            {"time": 4, "strength": [34, 29, 22]}]}]})");
    const std::string lit = " --scene " LUCARNE_SOURCE_DIR "/data/scenes/cornell.json";
    const auto fly = [&](const std::string& engine, const std::string& scene) {
        return test::lucarne("fly " + cache + " --path " + (folder / "path.json") + scene + " --engine " +
                             engine + " --preset preview --size 64x48 --bounces 1 --flicker --frames-dir " +
                             (folder / engine) + " -o " + (folder / (engine + ".json")));
    };
    for (const std::string engine : {"direct", "paths"}) {
        const Outcome flown = fly(engine, lit);
        ASSERT_EQ(flown.code, 0) << flown.output;
        const auto frame = [&](int number) {
            return bytes_of(folder / (engine + "/frame_0000" + std::to_string(number) + ".png"));
        };
        EXPECT_GT(frame(1).size(), 500u);
        EXPECT_EQ(frame(1), frame(2)) << engine;
        EXPECT_EQ(frame(1), frame(3)) << engine;
        EXPECT_NE(frame(3), frame(4)) << engine;
        const auto frames = nlohmann::json::parse(bytes_of(folder / (engine + ".json")))["each_frame"];
        ASSERT_EQ(frames.size(), 5u);
        EXPECT_EQ(frames[1]["flicker"], 0.0) << engine;
        EXPECT_EQ(frames[2]["flicker"], 0.0) << engine;
        EXPECT_GT(frames[3]["flicker"].get<double>(), .2) << engine << ": the light comes from elsewhere";
        // All light is the lamp's.
        EXPECT_NEAR(frames[4]["luminance"].get<double>() / frames[3]["luminance"].get<double>(), .2, 1e-4)
            << engine;
    }
    const Outcome dark = fly("direct", " --mood daylight --overwrite");
    EXPECT_EQ(dark.code, 3) << dark.output;
    EXPECT_THAT(dark.output, HasSubstr("the scene has no light of this name"));
    EXPECT_EQ(std::count(dark.output.begin(), dark.output.end(), '\n'), 1) << dark.output;
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

TEST(Fly, SeveralEnginesColdAndWarmAreOneReportAndOnePage) {
    const TemporaryFolder folder;
    const std::string cache = make_cornell(folder);
    write(folder / "path.json", kPath);
    const std::string call = "fly " + cache + " --path " + (folder / "path.json") +
                             " --size 48x32 --bounces 1 --cold" + " --engine direct,vpl --frames-dir " +
                             (folder / "frames") + " --html " + (folder / "r.html") + " -o " +
                             (folder / "r.json");
    const Outcome flown = test::lucarne(call);
    ASSERT_EQ(flown.code, 0) << flown.output;
    const auto report = nlohmann::json::parse(bytes_of(folder / "r.json"));
    ASSERT_EQ(report["flights"].size(), 4u);
    const std::array<std::pair<const char*, bool>, 4> expected = {
        {{"direct", true}, {"direct", false}, {"vpl", true}, {"vpl", false}}};
    for (size_t i = 0; i < expected.size(); ++i) {
        const auto& flight = report["flights"][i];
        EXPECT_EQ(flight["engine"], expected[i].first);
        EXPECT_EQ(flight["start"]["cold"], expected[i].second);
        EXPECT_GT(flight["start"]["complete_cut_seconds"].get<double>(), 0);
        EXPECT_FALSE(flight["machine"]["system"].get<std::string>().empty());
        EXPECT_FALSE(flight["build"]["revision"].get<std::string>().empty());
        EXPECT_EQ(flight["each_frame"][0]["passes_ms"].size(), flight["passes_ms"].size());
    }
    const std::string warm = bytes_of(folder / "frames/vpl/frame_00002.png");
    EXPECT_FALSE(warm.empty());
    EXPECT_EQ(warm, bytes_of(folder / "frames/vpl-cold/frame_00002.png"))
        << "where points come from is not seen";
    EXPECT_THAT(bytes_of(folder / "r.html"), HasSubstr("vpl, cold"));

    const Outcome same = test::lucarne("fly --compare " + (folder / "r.json") + " " + (folder / "r.json"));
    EXPECT_EQ(same.code, 0) << same.output;
    EXPECT_THAT(same.output, HasSubstr("direct, cold, wait: no difference"));
}

TEST(Fly, CompareSaysWhatIsSlowerByItsExitCode) {
    const TemporaryFolder folder;
    const auto report = [&](const std::string& name, double ms, const std::string& engine) {
        nlohmann::json frames = nlohmann::json::array();
        for (int i = 0; i < 40; ++i) frames.push_back({{"time", i}, {"ms", ms + i % 3}});
        write(folder / name,
              nlohmann::json{{"engine", engine}, {"mode", "wait"}, {"preset", "high"}, {"each_frame", frames}}
                  .dump());
        return folder / name;
    };
    const std::string fast = report("fast.json", 20, "vpl"), slow = report("slow.json", 30, "vpl");
    const Outcome slower = test::lucarne("fly --compare " + fast + " " + slow);
    EXPECT_EQ(slower.code, 1);
    EXPECT_THAT(slower.output, HasSubstr("B is slower than A"));
    const Outcome faster = test::lucarne("fly --compare " + slow + " " + fast);
    EXPECT_EQ(faster.code, 0) << faster.output;
    EXPECT_THAT(faster.output, HasSubstr("B is faster than A"));
    EXPECT_EQ(test::lucarne("fly --compare " + slow + " " + fast + " --margin 60").code, 0);
    write(folder / "none.json", "{}");
    EXPECT_EQ(test::lucarne("fly --compare " + slow + " " + (folder / "none.json")).code, 3);
    EXPECT_EQ(test::lucarne("fly --compare " + slow).code, 2);
}

TEST(Fly, SoakEndsWithTheMemoryItBeganWith) {
    const TemporaryFolder folder;
    const std::string cache = make_cornell(folder, "300k");
    write(folder / "path.json", kPath);
    // LUCARNE_SOAK sets a longer duration, for example an hour.
    const char* asked = std::getenv("LUCARNE_SOAK");
    const Outcome flown =
        test::lucarne("fly " + cache + " --path " + (folder / "path.json") + " --size 64x48 --realtime" +
                      " --engine direct --scene " LUCARNE_SOURCE_DIR
                      "/data/scenes/cornell.json --memory 8M --device-memory 16M --soak " +
                      (asked ? asked : "10") + " -o " + (folder / "r.json"));
    ASSERT_EQ(flown.code, 0) << flown.output;
    const auto report = nlohmann::json::parse(bytes_of(folder / "r.json"));
    const auto& soak = report["soak"];
    std::printf("%s laps, %s frames, resident %s, device %s\n", soak["laps"].dump().c_str(),
                soak["frames"].dump().c_str(), soak["resident_memory"].dump().c_str(),
                soak["device_memory"].dump().c_str());
    EXPECT_GE(soak["laps"].get<int>(), 2);
    EXPECT_LT(soak["resident_memory"]["growth"].get<double>(), 16 << 20);
    EXPECT_LE(report["memory"]["used"].get<double>(), report["memory"]["cap"].get<double>());
    EXPECT_LE(report["device_memory"]["used"].get<double>(), report["device_memory"]["cap"].get<double>());
}

TEST(Fly, PoppingIsMeasuredAgainstTheSameFlightWithEveryPoint) {
    const TemporaryFolder folder;
    const std::string cache = make_cornell(folder);
    write(folder / "path.json", R"({"frames_per_second": 12, "keys": [
        {"time": 0, "position": [2.7, 0.4, 2.7], "target": [2.7, 5, 2.4]},
        {"time": 1, "position": [2.6, 0.6, 2.75], "target": [2.75, 5, 2.35]}]})");
    const auto fly = [&](const std::string& name, const std::string& more) {
        const Outcome flown =
            test::lucarne("fly " + cache + " --path " + (folder / "path.json") +
                          " --engine direct --popping" + " --size 96x72 -o " + (folder / name) + more);
        EXPECT_EQ(flown.code, 0) << flown.output;
        return nlohmann::json::parse(bytes_of(folder / name));
    };
    const auto report = fly("r.json", " --points 20000");
    EXPECT_EQ(report["popping"]["full_cut_share"], 1.0);
    EXPECT_GT(report["picture_change"]["max"].get<double>(), 0);
    std::printf("popping %s\n", report["popping"].dump().c_str());
    EXPECT_LT(report["popping"]["ratio"].get<double>(), 2);
}

TEST(Fly, TwoHundredCachesAreOneSceneUnderOneBudget) {
    const TemporaryFolder folder;
    const std::string cache = make_cornell(folder, "2k");
    std::string inputs;
    for (int i = 0; i < 200; ++i) {
        const std::string copy = folder / ("scan" + std::to_string(i) + ".luc");
        std::filesystem::copy_file(cache, copy);
        inputs += copy + " ";
    }
    write(folder / "path.json", kPath);
    // Fewer file handles than caches.
    const Outcome flown =
        test::shell("ulimit -n 128; " LUCARNE_BINARY " fly " + inputs + " --path " + (folder / "path.json") +
                    " --size 48x32 --points 50000 --engine direct -o " + (folder / "r.json"));
    ASSERT_EQ(flown.code, 0) << flown.output;
    const auto report = nlohmann::json::parse(bytes_of(folder / "r.json"));
    EXPECT_EQ(report["input"].size(), 200u);
    EXPECT_LE(report["points_per_frame"]["view"]["max"].get<double>(), 50'000);
    EXPECT_GT(report["points_per_frame"]["view"]["max"].get<double>(), 40'000);
    EXPECT_EQ(report["complete"]["least"], 1.0);
}

TEST(Fly, FrameTimeIsForFlightsByTheClock) {
    const TemporaryFolder folder;
    const std::string cache = make_cornell(folder);
    write(folder / "path.json", kPath);
    const std::string call = "fly " + cache + " --path " + (folder / "path.json") +
                             " --size 64x48 --engine direct" + " --frame-time 5 -o " + (folder / "r.json");
    EXPECT_EQ(test::lucarne(call).code, 2);
    const Outcome flown = test::lucarne(call + " --realtime");
    ASSERT_EQ(flown.code, 0) << flown.output;
    EXPECT_EQ(nlohmann::json::parse(bytes_of(folder / "r.json"))["frame_time_ms"], 5.0);
}

}  // namespace
}  // namespace lucarne
