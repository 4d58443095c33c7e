#include "viewer/flythrough/path.h"

#include <filesystem>
#include <numbers>

#include <glm/geometric.hpp>
#include <gmock/gmock.h>
#include <gtest/gtest.h>

namespace lucarne::viewer {
namespace {

using testing::HasSubstr;

CameraPath path_of(std::string_view text) {
    auto path = parse_path(text, "path.json");
    EXPECT_TRUE(path) << path.error().line();
    return path ? *path : CameraPath{};
}

constexpr std::string_view kUneven = R"({"frames_per_second": 10, "keys": [
    {"time": 1, "position": [0, 0, 0], "target": [0, 5, 0], "fov": 40},
    {"time": 2, "position": [1, 0, 0], "target": [1, 5, 0]},
    {"time": 4, "position": [3, 2, 1], "target": [3, 7, 0]},
    {"time": 4.5, "position": [2, 4, 1], "target": [3, 9, 0], "up": [0, 0.1, 1]}]})";

TEST(CameraPath, PassesThroughItsKeyFrames) {
    const CameraPath path = path_of(kUneven);
    ASSERT_EQ(path.keys.size(), 4u);
    for (const KeyFrame& key : path.keys) {
        const gi::SceneCamera camera = path.at(key.time);
        EXPECT_LT(glm::distance(camera.position, key.camera.position), 1e-12);
        EXPECT_LT(glm::distance(camera.target, key.camera.target), 1e-12);
        EXPECT_NEAR(camera.vertical_fov, key.camera.vertical_fov, 1e-12);
    }
    EXPECT_NEAR(path.keys[0].camera.vertical_fov, 40 * std::numbers::pi / 180, 1e-12);
    EXPECT_EQ(path.keys[1].camera.up, glm::dvec3(0, 0, 1));
}

TEST(CameraPath, GoesStraightAndEvenlyBetweenKeysThatDo) {
    // Positions linear in time, times uneven: the curve is that line.
    const CameraPath path = path_of(R"({"keys": [
        {"time": 0, "position": [0, 0, 1], "target": [0, 9, 1]}, {"time": 1, "position": [0, 2, 1], "target": [0, 9, 1]},
        {"time": 4, "position": [0, 8, 1], "target": [0, 9, 1]}]})");
    for (double time = 0; time <= 4; time += 0.01) EXPECT_NEAR(path.at(time).position.y, 2 * time, 1e-12);
}

TEST(CameraPath, NeitherPlaceNorSpeedJumpsAtAKeyFrame) {
    const CameraPath path = path_of(kUneven);
    constexpr double kStep = 1e-6;
    const auto velocity = [&](double time) {
        return (path.at(time + kStep).position - path.at(time).position) / kStep;
    };
    for (const double key : {2.0, 4.0}) {
        EXPECT_LT(glm::distance(path.at(key - kStep).position, path.at(key).position), 1e-5);
        EXPECT_LT(glm::distance(velocity(key - 2 * kStep), velocity(key + kStep)), 1e-4);
    }
}

TEST(CameraPath, RestsBetweenKeyFramesThatAgree) {
    const CameraPath path = path_of(R"({"keys": [
        {"time": 0, "position": [0.1, 0, 1.7], "target": [0.3, 9, 1], "fov": 50},
        {"time": 1, "position": [0.7, 2, 1.7], "target": [0.3, 9, 1], "fov": 61},
        {"time": 4, "position": [0.7, 2, 1.7], "target": [0.3, 9, 1], "fov": 61},
        {"time": 5, "position": [2, 8, 1.1], "target": [3, 9, 1], "fov": 40}]})");
    for (double time = 1; time <= 4; time += .013) EXPECT_EQ(path.at(time), path.keys[1].camera) << time;
    EXPECT_NE(path.at(4.1), path.keys[1].camera);
}

TEST(CameraPath, CountsItsFramesAndStaysWithinItsTime) {
    const CameraPath path = path_of(kUneven);
    EXPECT_EQ(path.frames(), 36u) << "3.5 s at 10 frames a second, both ends";
    EXPECT_EQ(path.at(-5).position, path.keys.front().camera.position);
    EXPECT_EQ(path.at(99).position, path.keys.back().camera.position);
    const CameraPath still =
        path_of(R"({"keys": [{"time": 0, "position": [0, 0, 1], "target": [0, 9, 1]}]})");
    EXPECT_EQ(still.frames(), 1u);
    EXPECT_EQ(still.at(1).target.y, 9);
    const CameraPath third = path_of(R"({"frames_per_second": 3, "keys": [{"time": 0, "position": [0, 0, 1],
        "target": [0, 9, 1]}, {"time": 0.3333333333333333, "position": [1, 0, 1], "target": [0, 9, 1]}]})");
    EXPECT_EQ(third.frames(), 2u) << "rounding does not drop the last frame";
}

TEST(CameraPath, MistakesNameTheirPlace) {
    const auto key = [](const std::string& more) {
        return R"({"keys": [{"time": 0, "position": [0, 0, 0], )" + more + "}]}";
    };
    const std::pair<std::string, const char*> cases[] = {
        {"{\n\"keys\": [\n}", "path.json: line 3"},
        {"{}", "/keys: must hold at least one"},
        {R"({"keys": [{"position": [0, 0, 0]}]})", "/keys/0: the key 'time' is missing"},
        {key(R"("target": [0, 0])"), "/keys/0/target: must be three numbers"},
        {key(R"("target": [0, 0, 0])"), "/keys/0/target: is where the camera stands"},
        {key(R"("target": [0, 0, 4])"), "/keys/0/up: is zero or points along the view"},
        {key(R"("target": [0, 4, 0], "up": [0, 0, 0])"), "/keys/0/up: is zero"},
        {key(R"("target": [0, 4, 0], "fov": 180)"), "/keys/0/fov: must be a number from 1 to 170"},
        {key(R"("target": [0, 4, 0], "zoom": 2)"), "/keys/0/zoom: is not a known key"},
        {key(R"("target": [0, 4, 0]}, {"time": 0, "position": [0, 0, 0], "target": [0, 4, 0])"),
         "/keys/1/time: must be later than 0 s"},
        {R"({"frames_per_second": 1000, "keys": [{"time": 0, "position": [0, 0, 0], "target": [0, 1, 0]},
            {"time": 2000, "position": [0, 0, 0], "target": [0, 1, 0]}]})",
         "/frames_per_second: gives more than a million"},
    };
    for (const auto& [text, expected] : cases) {
        const auto path = parse_path(text, "path.json");
        ASSERT_FALSE(path) << text;
        EXPECT_EQ(path.error().kind, ErrorKind::input_rejected);
        EXPECT_THAT(path.error().line(), HasSubstr(expected));
    }
    EXPECT_FALSE(load_path("/nowhere/path.json"));
}

TEST(CameraPath, EveryPathOfTheRepositoryIsSound) {
    size_t paths = 0;
    for (const auto& entry : std::filesystem::directory_iterator(LUCARNE_SOURCE_DIR "/data/flythroughs")) {
        const auto path = load_path(entry.path());
        EXPECT_TRUE(path) << path.error().line();
        ++paths;
    }
    EXPECT_GE(paths, 2u);
}

}  // namespace
}  // namespace lucarne::viewer
