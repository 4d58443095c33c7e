// Tests the one history of undo for everything that the window changes.
#include "viewer/window/undo_history.h"

#include <gtest/gtest.h>

#include "viewer/light/edits.h"
#include "viewer/style/look_edits.h"
#include "viewer/window/view_model.h"

namespace lucarne::viewer {
namespace {

class Undo : public testing::Test {
 protected:
    Undo() { follow(); }
    void follow() { model_.history.follow(model_); }
    /// Undoes, and returns the message.
    std::string undo() {
        model_.history.undo(model_);
        return model_.view.message;
    }
    std::string redo() {
        model_.history.redo(model_);
        return model_.view.message;
    }
    void measure() {
        ASSERT_TRUE(model_.measure.list.add({MeasureKind::point, "", {ExactPoint{}}, 0}));
        follow();
    }
    void clip() {
        add_clip_box(model_.styling());
        follow();
    }
    void move_clip(double by) { model_.view.scene.look.clip.boxes.front().max.x += by; }

    ViewModel model_{10};
};

TEST_F(Undo, WalksBackAndForthInTheOrderOfTheChanges) {
    add_light(model_.lighting(), gi::LightKind::spot);
    follow();
    measure();
    clip();
    const gi::Clip before = model_.view.scene.look.clip;
    for (int frame = 0; frame < 3; ++frame) move_clip(1);  // a drag
    follow();
    const gi::Clip after = model_.view.scene.look.clip;
    model_.view.scene.lights[0].position.x += 1;
    follow();
    model_.view.scene.look.point_size = 2;
    follow();
    gi::SceneCamera camera;
    camera.target = {0, 1, 0};
    model_.publish.add_key(camera);
    follow();

    EXPECT_EQ(undo(), "Undone: key frame added");
    EXPECT_TRUE(model_.publish.editor.empty());
    EXPECT_EQ(undo(), "Undone: appearance changed");
    EXPECT_EQ(undo(), "Undone: light moved");
    EXPECT_EQ(undo(), "Undone: clip moved");
    EXPECT_EQ(model_.view.scene.look.clip, before);
    EXPECT_EQ(model_.measure.list.all().size(), 1u) << "older than the clip";
    EXPECT_EQ(undo(), "Undone: clip added");
    EXPECT_EQ(undo(), "Undone: measurement added");
    EXPECT_TRUE(model_.measure.list.all().empty());
    EXPECT_EQ(undo(), "Undone: light added");
    EXPECT_TRUE(model_.view.scene.lights.empty());
    EXPECT_FALSE(model_.history.can_undo());
    model_.view.message.clear();
    EXPECT_EQ(undo(), "") << "nothing is left";

    for (int i = 0; i < 4; ++i) redo();
    EXPECT_EQ(model_.view.message, "Redone: clip moved");
    EXPECT_EQ(model_.view.scene.look.clip, after);
    measure();
    EXPECT_FALSE(model_.history.can_redo()) << "another way was taken";
}

TEST_F(Undo, FollowingAnUndoneStepIsNoStep) {
    clip();
    undo();
    follow();
    EXPECT_TRUE(model_.history.can_redo());
    EXPECT_FALSE(model_.history.can_undo());
}

TEST_F(Undo, InTheMiddleOfADragTakesTheDragBack) {
    clip();
    const gi::Clip before = model_.view.scene.look.clip;
    move_clip(1);
    EXPECT_EQ(undo(), "Undone: clip moved");
    EXPECT_EQ(model_.view.scene.look.clip, before);
}

TEST_F(Undo, LeavesAloneWhatTheProgramChanges) {
    measure();
    model_.history.without_step(model_, [&] { add_light(model_.lighting(), gi::LightKind::spot); });
    follow();
    EXPECT_EQ(undo(), "Undone: measurement added");
    EXPECT_EQ(model_.view.scene.lights.size(), 1u);
    EXPECT_FALSE(model_.history.can_undo());
}

TEST_F(Undo, BringsTheMoodAndItsEngineBack) {
    model_.view.site.outline = {glm::dvec3(0), glm::dvec3(1)};
    model_.view.site.box = {glm::dvec3(0), glm::dvec3(1)};
    model_.view.method.engine = "unlit";
    model_.lights.mood = Mood::scan_colours;
    model_.history.restart(model_);
    take_mood(model_.lighting(), Mood::daylight);
    follow();
    add_light(model_.lighting(), gi::LightKind::spot);
    follow();
    EXPECT_EQ(model_.lights.mood, std::nullopt);
    EXPECT_EQ(undo(), "Undone: light added");
    EXPECT_EQ(model_.lights.mood, Mood::daylight);
    EXPECT_EQ(undo(), "Undone: mood changed");
    EXPECT_EQ(model_.lights.mood, Mood::scan_colours);
    EXPECT_EQ(model_.view.method.engine, "unlit");
    EXPECT_TRUE(model_.view.scene.lights.empty());
}

TEST_F(Undo, HoldsALimitedNumberOfSteps) {
    clip();
    for (size_t i = 0; i < UndoHistory::kMostSteps + 20; ++i) {
        move_clip(1);
        follow();
    }
    size_t steps = 0;
    for (; model_.history.can_undo(); ++steps) undo();
    EXPECT_EQ(steps, UndoHistory::kMostSteps);
    EXPECT_EQ(model_.view.scene.look.clip.boxes.size(), 1u);
}

TEST_F(Undo, HoldsALimitedSizeOfSkies) {
    constexpr size_t kTexels = UndoHistory::kMostSkyBytes / sizeof(glm::vec3) / 4;  // three skies fit
    for (int i = 0; i < 6; ++i) {
        auto sky = std::make_shared<gi::Environment>();
        sky->texels.resize(kTexels + 1);
        model_.view.scene.environment = std::move(sky);
        follow();
    }
    size_t steps = 0;
    for (; model_.history.can_undo(); ++steps) EXPECT_EQ(undo(), "Undone: sky changed");
    EXPECT_EQ(steps, 2u) << "from the first of three to the second, and to the third";
}

TEST_F(Undo, EndsWhereTheUnitOfTheMeasurementsChanges) {
    measure();
    model_.measure.set_unit(0.3048);
    follow();
    EXPECT_FALSE(model_.history.can_undo());
}

}  // namespace
}  // namespace lucarne::viewer
