#include "viewer/publish/editor.h"

#include <cmath>
#include <fstream>
#include <limits>
#include <numbers>
#include <random>

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "tests/viewer/program.h"
#include "viewer/publish/model.h"

namespace lucarne::viewer {
namespace {

using testing::HasSubstr;

gi::SceneCamera camera_at(double x) {
    gi::SceneCamera camera;
    camera.position = {x, 0.1 * x, 1.7};
    camera.target = {x, 5, 1.0 / 3};
    camera.vertical_fov = 50.1 * std::numbers::pi / 180;
    return camera;
}

PathEditor with_keys(int count) {
    PathEditor editor;
    for (int i = 0; i < count; ++i) EXPECT_TRUE(editor.add(camera_at(i)));
    return editor;
}

void expect_same(const CameraPath& a, const CameraPath& b) {
    EXPECT_EQ(a.frames_per_second, b.frames_per_second);
    ASSERT_EQ(a.keys.size(), b.keys.size());
    for (size_t i = 0; i < a.keys.size(); ++i) {
        EXPECT_EQ(a.keys[i].time, b.keys[i].time) << i;
        EXPECT_EQ(a.keys[i].camera.position, b.keys[i].camera.position) << i;
        EXPECT_EQ(a.keys[i].camera.target, b.keys[i].camera.target) << i;
        EXPECT_EQ(a.keys[i].camera.up, b.keys[i].camera.up) << i;
        EXPECT_EQ(a.keys[i].camera.vertical_fov, b.keys[i].camera.vertical_fov) << i;
    }
}

TEST(PathEditor, AddsAfterTheSelectedKeyFrame) {
    PathEditor editor = with_keys(3);
    EXPECT_EQ(editor.path().keys.back().time, 2 * PathEditor::kStep);
    EXPECT_EQ(editor.selected(), 2u);
    editor.select(0);
    ASSERT_TRUE(editor.add(camera_at(9)));
    ASSERT_EQ(editor.path().keys.size(), 4u);
    EXPECT_EQ(editor.path().keys[1].camera.position.x, 9);
    EXPECT_EQ(editor.path().keys[1].time, PathEditor::kStep / 2);
    EXPECT_EQ(editor.selected(), 1u);
}

TEST(PathEditor, KeyFramesStayInTheOrderOfTheirTimes) {
    PathEditor editor = with_keys(3);
    editor.select(0);
    ASSERT_TRUE(editor.set_time(3));
    EXPECT_EQ(editor.selected(), 1u) << "the selection goes with it";
    EXPECT_EQ(editor.path().keys[0].camera.position.x, 1);
    EXPECT_EQ(editor.path().keys[1].camera.position.x, 0);
    ASSERT_TRUE(editor.move(1));
    EXPECT_EQ(editor.selected(), 2u);
    EXPECT_EQ(editor.path().keys[2].camera.position.x, 0) << "cameras change places";
    EXPECT_EQ(editor.path().keys[2].time, 4) << "times stay";
    ASSERT_TRUE(editor.move(1));
    EXPECT_EQ(editor.path().keys[2].camera.position.x, 0) << "there is no later one";
}

TEST(PathEditor, WhatTheReaderWouldRefuseIsRefusedAndChangesNothing) {
    PathEditor editor = with_keys(2);
    const std::string before = path_text(editor.path());
    const double nan = std::numeric_limits<double>::quiet_NaN();
    gi::SceneCamera nowhere = camera_at(0), downward = camera_at(0), parallel = camera_at(0);
    nowhere.target = nowhere.position;
    downward.target = downward.position - glm::dvec3(0, 0, 1);
    parallel.orthographic_height = 4;
    EXPECT_THAT(editor.set_time(0).error().line(), HasSubstr("must be later than 0 s"));
    EXPECT_FALSE(editor.set_time(-1));
    EXPECT_FALSE(editor.set_time(nan));
    EXPECT_FALSE(editor.set_fov(std::numbers::pi));
    EXPECT_FALSE(editor.set_fov(nan));
    EXPECT_FALSE(editor.replace(nowhere));
    EXPECT_THAT(editor.replace(downward).error().line(), HasSubstr("/up"));
    EXPECT_THAT(editor.add(parallel).error().line(), HasSubstr("perspective"));
    EXPECT_FALSE(editor.set_frames_per_second(0));
    EXPECT_EQ(path_text(editor.path()), before);
    EXPECT_EQ(editor.selected(), 1u);
}

TEST(PathEditor, AnyEditsGiveAFileThatReadsAsWhatIsEdited) {
    const test::TemporaryFolder folder;
    const std::string file = folder / "path.json";
    std::mt19937 random(7);
    std::uniform_real_distribution<double> place(-1e6, 1e6), time(-1, 40), fov(-0.1, 3.2);
    PathEditor editor;
    for (int edit = 0; edit < 400; ++edit) {
        editor.select(random() % (editor.path().keys.size() + 1));
        gi::SceneCamera camera = camera_at(place(random));
        camera.vertical_fov = fov(random);
        Result<void> done;
        switch (random() % 7) {
            case 0:
            case 1:
                done = editor.add(camera);
                break;
            case 2:
                done = editor.replace(camera);
                break;
            case 3:
                done = editor.set_time(time(random));
                break;
            case 4:
                done = editor.set_fov(fov(random));
                break;
            case 5:
                done = editor.move(static_cast<int>(random() % 5) - 2);
                break;
            default:
                done = random() % 2 ? editor.remove() : editor.set_frames_per_second(time(random));
        }
        if (editor.empty()) {
            EXPECT_FALSE(editor.save(file, true));
            continue;
        }
        ASSERT_TRUE(editor.save(file, true));
        const auto read = load_path(file);
        ASSERT_TRUE(read) << read.error().line();
        expect_same(*read, editor.path());
    }
    EXPECT_GT(editor.path().keys.size(), 10u);
}

TEST(PathEditor, SavesWhatItLoadedByteForByteAndOverwritesNothing) {
    const test::TemporaryFolder folder;
    for (const char* name : {"cornell", "nave"}) {
        PathEditor editor;
        ASSERT_TRUE(editor.load(std::string(LUCARNE_SOURCE_DIR "/data/flythroughs/") + name + ".json"));
        const std::string first = folder / (std::string(name) + "1.json"), second = first + "2";
        ASSERT_TRUE(editor.save(first, false));
        EXPECT_FALSE(editor.save(first, false)) << "it exists";
        PathEditor again;
        ASSERT_TRUE(again.load(first));
        expect_same(again.path(), editor.path());
        ASSERT_TRUE(again.save(second, false));
        EXPECT_EQ(test::bytes_of(first), test::bytes_of(second));
    }
    PathEditor editor = with_keys(2);
    std::ofstream(folder / "broken.json") << "{\"keys\": [{}]}";
    EXPECT_FALSE(editor.load(folder / "broken.json"));
    EXPECT_EQ(editor.path().keys.size(), 2u) << "what was there stays";
}

TEST(PathEditor, RestoresPathsAndHoldsASelectionThatIsThere) {
    PathEditor editor = with_keys(3);
    const std::string before = path_text(editor.path());
    const PathEditor::State state = editor.state();
    ASSERT_TRUE(editor.remove());
    EXPECT_EQ(editor.selected(), 1u);
    editor.become(state);
    EXPECT_EQ(path_text(editor.path()), before);
    editor.become(PathEditor().state());
    EXPECT_TRUE(editor.empty());
    EXPECT_EQ(editor.selected(), std::nullopt);
    editor.select(4);
    EXPECT_EQ(editor.selected(), std::nullopt);
    EXPECT_TRUE(editor.remove()) << "nothing is selected: nothing happens";
}

TEST(PublishModel, ThePreviewEndsWithThePathAndBeginsAgain) {
    PublishModel show;
    show.play();
    EXPECT_FALSE(show.playing) << "there is nothing to play";
    show.editor = with_keys(2);
    show.play();
    show.advance(1.5);
    EXPECT_TRUE(show.playing);
    EXPECT_EQ(show.time, 1.5);
    show.advance(60);
    EXPECT_FALSE(show.playing);
    EXPECT_EQ(show.time, PathEditor::kStep);
    show.play();
    EXPECT_EQ(show.time, 0);
    show.go_to_key(1);
    EXPECT_EQ(show.time, PathEditor::kStep);
    EXPECT_EQ(show.editor.selected(), 1u);
}

TEST(PublishModel, TheDrawnPathIsTheFlownOne) {
    const PathEditor editor = with_keys(4);
    const auto places = places_along(editor.path(), 1000);
    ASSERT_GE(places.size(), 4u);
    EXPECT_EQ(places.front(), editor.path().keys.front().camera.position);
    EXPECT_EQ(places.back(), editor.path().keys.back().camera.position);
    EXPECT_EQ(places[places.size() / 3], editor.path().keys[1].camera.position);
    EXPECT_EQ(places_along(editor.path(), 10).size(), 10u);
    EXPECT_TRUE(places_along({}, 10).empty());
}

}  // namespace
}  // namespace lucarne::viewer
