// Tests which work of the user counts as unsaved, and how it is saved.
#include "viewer/window/unsaved.h"

#include <gmock/gmock.h>

#include "io/files/file.h"
#include "tests/viewer/program.h"
#include "viewer/light/edits.h"
#include "viewer/measure/file.h"

namespace lucarne::viewer {
namespace {

using test::TemporaryFolder;
using testing::ElementsAre;
using testing::HasSubstr;

ExactPoint point_at(double x) {
    ExactPoint point;
    point.position = {x, 0, 0};
    point.coordinates = {std::to_string(x), "0", "0"};
    return point;
}
Measurement distance(double length) {
    return {MeasureKind::distance, "", {point_at(0), point_at(length)}, 0};
}
gi::SceneCamera camera_at(double x) {
    gi::SceneCamera camera;
    camera.position = {x, 0, 2};
    camera.target = {x, 5, 1};
    return camera;
}

/// A window's model with an unchanged scene.
class UnsavedWork : public testing::Test {
 protected:
    UnsavedWork() {
        model_.view.pictures = folder_.path();
        add_light(model_.lighting(), gi::LightKind::spot);
        model_.scene_file.mark(model_.view);
    }
    std::vector<std::string> named(SaveTo to = SaveTo::own_files) const {
        std::vector<std::string> all;
        for (const Unsaved& one : unsaved(model_, to))
            all.push_back(one.what + " -> " + one.file.filename().string());
        return all;
    }
    void change_everything() {
        ASSERT_TRUE(model_.measure.list.add(distance(2)));
        model_.publish.add_key(camera_at(1));
        add_light(model_.lighting(), gi::LightKind::point);
    }

    const TemporaryFolder folder_;
    ViewModel model_{10};
};

TEST_F(UnsavedWork, IsNoneInAWindowThatWasOnlyLookedAround) {
    EXPECT_THAT(named(), ElementsAre());
    model_.view.rig.orbit(0.1, 0.2);
    model_.view.message = "moved";
    EXPECT_THAT(named(), ElementsAre());
}

TEST_F(UnsavedWork, IsListedWithTheFilesThatItGoesInto) {
    change_everything();
    EXPECT_THAT(named(), ElementsAre("1 measurement -> measurements.json",
                                     "a flythrough of 1 key frame -> flythrough.json",
                                     "the scene: lights, look or clips were changed -> scene-0001.json"));
}

TEST_F(UnsavedWork, IsNoneOnceItIsSavedAndUntilTheNextChange) {
    change_everything();
    ASSERT_TRUE(save_unsaved(model_));
    EXPECT_THAT(named(), ElementsAre());
    EXPECT_EQ(load_measurements(folder_ / "measurements.json", std::nullopt)->size(), 1u);
    EXPECT_EQ(load_path(folder_ / "flythrough.json")->keys.size(), 1u);
    EXPECT_EQ(gi::load_scene(folder_ / "scene-0001.json")->lights.size(), 2u);
    change_everything();
    EXPECT_THAT(named(), ElementsAre("2 measurements -> measurements.json",
                                     "a flythrough of 2 key frames -> flythrough.json",
                                     "the scene: lights, look or clips were changed -> scene-0001.json"));
    ASSERT_TRUE(save_unsaved(model_)) << "over its own files";
    EXPECT_THAT(named(), ElementsAre());
}

TEST_F(UnsavedWork, IsNoneWhereEveryChangeWasTakenBack) {
    model_.history.follow(model_);
    ASSERT_TRUE(model_.measure.list.add(distance(2)));
    model_.history.follow(model_);
    model_.publish.add_key(camera_at(1));
    model_.history.follow(model_);
    add_light(model_.lighting(), gi::LightKind::point);
    for (int i = 0; i < 3; ++i) model_.history.undo(model_);
    EXPECT_THAT(named(), ElementsAre());
    model_.history.redo(model_);
    EXPECT_THAT(named(), ElementsAre("1 measurement -> measurements.json"));
}

TEST_F(UnsavedWork, IsAChangeOfWhatWasLoadedAndNotTheLoadingItself) {
    change_everything();
    ASSERT_TRUE(save_unsaved(model_));
    ViewModel other(10);
    ASSERT_TRUE(other.measure.load(folder_ / "measurements.json"));
    ASSERT_TRUE(other.publish.load_path(folder_ / "flythrough.json"));
    EXPECT_TRUE(unsaved(other).empty());
    other.measure.list.rename(0, "door");
    EXPECT_EQ(unsaved(other).size(), 1u);
}

TEST_F(UnsavedWork, StaysTheSameWhenAnotherScanBringsAnotherUnit) {
    ASSERT_TRUE(model_.measure.list.add(distance(2)));
    model_.measure.set_unit(0.3048);
    EXPECT_THAT(named(), ElementsAre("1 measurement -> measurements.json"));
    ASSERT_TRUE(save_unsaved(model_));
    model_.measure.set_unit(1);
    EXPECT_THAT(named(), ElementsAre());
}

TEST_F(UnsavedWork, CountsAMeasurementWhosePointsAreEnough) {
    model_.measure.start(MeasureKind::path);
    for (int i = 0; i < 5; ++i) model_.measure.take(point_at(i));
    EXPECT_THAT(named(), ElementsAre("1 measurement -> measurements.json"));
    ASSERT_TRUE(save_unsaved(model_));
    EXPECT_EQ(load_measurements(folder_ / "measurements.json", std::nullopt)->front().points.size(), 5u);
    EXPECT_THAT(named(), ElementsAre());
}

TEST_F(UnsavedWork, NeverReplacesFilesOfOthers) {
    for (const char* name :
         {"measurements.json", "measurements-0001.json", "flythrough.json", "scene-0001.json"})
        ASSERT_TRUE(write_file(folder_ / name, "mine", false));
    change_everything();
    EXPECT_THAT(named(), ElementsAre("1 measurement -> measurements-0002.json",
                                     "a flythrough of 1 key frame -> flythrough-0001.json",
                                     "the scene: lights, look or clips were changed -> scene-0002.json"));
    ASSERT_TRUE(save_unsaved(model_));
    EXPECT_EQ(test::bytes_of(folder_ / "measurements.json"), "mine");
    EXPECT_EQ(test::bytes_of(folder_ / "scene-0001.json"), "mine");
}

TEST_F(UnsavedWork, WithoutAQuestionGoesBesideItsOwnFiles) {
    change_everything();
    ASSERT_TRUE(save_unsaved(model_));
    change_everything();
    ASSERT_TRUE(save_unsaved(model_, SaveTo::free_names));
    EXPECT_EQ(load_measurements(folder_ / "measurements.json", std::nullopt)->size(), 1u)
        << "as it was saved";
    EXPECT_EQ(load_measurements(folder_ / "measurements-0001.json", std::nullopt)->size(), 2u);
    EXPECT_EQ(load_path(folder_ / "flythrough-0001.json")->keys.size(), 2u);
    EXPECT_EQ(gi::load_scene(folder_ / "scene-0001-0001.json")->lights.size(), 3u);
}

TEST_F(UnsavedWork, WithoutAQuestionGoesIntoNoFolderOfAnotherFile) {
    std::filesystem::create_directory(folder_ / "theirs");
    ASSERT_TRUE(model_.scene_file.save_as(model_.view, folder_ / "theirs/lit.json"));
    add_light(model_.lighting(), gi::LightKind::point);
    EXPECT_THAT(named(), ElementsAre("the scene: lights, look or clips were changed -> lit.json"))
        << "as it asks";
    ASSERT_TRUE(save_unsaved(model_, SaveTo::free_names));
    EXPECT_EQ(gi::load_scene(folder_ / "theirs/lit.json")->lights.size(), 1u);
    EXPECT_EQ(gi::load_scene(folder_ / "lit.json")->lights.size(), 2u);
}

TEST_F(UnsavedWork, ThatCannotBeSavedIsAnErrorAndStaysUnsaved) {
    change_everything();
    model_.measure.file = "measurements.txt";
    const auto saved = save_unsaved(model_);
    ASSERT_FALSE(saved);
    EXPECT_THAT(saved.error().line(), HasSubstr("measurements.txt"));
    EXPECT_THAT(named(), ElementsAre("1 measurement -> measurements.txt")) << "the others are saved";
}

}  // namespace
}  // namespace lucarne::viewer
