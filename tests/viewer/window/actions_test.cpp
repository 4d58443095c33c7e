#include "viewer/window/actions/actions.h"

#include <fstream>

#define GLFW_INCLUDE_NONE
#include <GLFW/glfw3.h>
#include <gmock/gmock.h>
#include <imgui.h>

#include "gi/bake/bake_file.h"
#include "tests/viewer/program.h"
#include "viewer/light/preparing.h"

namespace lucarne::viewer {
namespace {

TEST(Actions, EachHasAKeyOfItsOwnAPlaceInAMenuAndAName) {
    ViewModel model(10);
    const auto actions = bound_actions(model);
    for (const BoundAction& action : actions) {
        EXPECT_NE(action.chord.key, 0) << action.name;
        EXPECT_NE(std::string(action.menu), "") << action.name;
        EXPECT_TRUE(action.run && action.enabled && action.checked) << action.name;
        for (const BoundAction& other : actions) {
            if (&other == &action) continue;
            EXPECT_NE(other.chord, action.chord)
                << key_text(action.chord) << ": " << action.name << " and " << other.name;
            EXPECT_NE(other.chord, action.other) << action.name << " and " << other.name;
            EXPECT_FALSE(std::string(other.name) == action.name && std::string(other.menu) == action.menu)
                << action.name;
        }
    }
}

TEST(Actions, LeaveTheKeysThatFlyAlone) {
    ViewModel model(10);
    for (const BoundAction& action : bound_actions(model))
        for (const int key : {GLFW_KEY_W, GLFW_KEY_A, GLFW_KEY_S, GLFW_KEY_D, GLFW_KEY_Q, GLFW_KEY_E})
            EXPECT_NE(action.chord, (KeyChord{key, 0})) << action.name;
}

TEST(Actions, KeysAreWrittenAsPeopleWriteThem) {
    EXPECT_EQ(key_text({GLFW_KEY_O, GLFW_MOD_CONTROL}), "Ctrl+O");
    EXPECT_EQ(key_text({GLFW_KEY_F12, GLFW_MOD_CONTROL | GLFW_MOD_SHIFT | GLFW_MOD_ALT}),
              "Ctrl+Alt+Shift+F12");
    EXPECT_EQ(key_text({GLFW_KEY_PAGE_UP}), "Page up");
    ViewModel model(10);
    for (const BoundAction& action : bound_actions(model))
        EXPECT_EQ(key_text(action.chord).find("key "), std::string::npos);
}

TEST(Actions, RunByTheirKeyWithWhatIsHeldDownBesideItAndOnlyWhereEnabled) {
    ViewModel model(10);
    const auto actions = bound_actions(model);
    const KeyChord help{GLFW_KEY_F1}, help_shifted{GLFW_KEY_F1, GLFW_MOD_SHIFT}, picture{GLFW_KEY_F12};
    run_actions(actions, std::array{help_shifted});
    EXPECT_FALSE(model.show_help);
    run_actions(actions, std::array{help, picture});
    EXPECT_TRUE(model.show_help);
    EXPECT_TRUE(model.commands.empty()) << "there is no picture to save";
}

TEST(Actions, ASceneIsSavedUnderANameThatTheUserGivesTheFirstTime) {
    ViewModel model(10);
    const test::TemporaryFolder folder;
    model.view.pictures = folder.path();
    const auto actions = bound_actions(model);
    const KeyChord save{GLFW_KEY_S, GLFW_MOD_CONTROL}, save_as{GLFW_KEY_S, GLFW_MOD_CONTROL | GLFW_MOD_ALT};
    run_actions(actions, std::array{save});
    EXPECT_TRUE(model.scene_name.shown);
    EXPECT_EQ(model.scene_name.file, folder / "lucarne-scene.json");
    EXPECT_TRUE(model.commands.empty());
    model.scene_name.shown = false;
    model.scene_file.set_path(folder / "mine.json");
    run_actions(actions, std::array{save});
    EXPECT_FALSE(model.scene_name.shown);
    EXPECT_FALSE(model.commands.empty());
    run_actions(actions, std::array{save_as});
    EXPECT_TRUE(model.scene_name.shown);
}

TEST(Actions, MoodsLightWhatIsOpenAndScanColoursNeedNoLight) {
    ViewModel model(10);
    const auto actions = bound_actions(model);
    const KeyChord colours{GLFW_KEY_1, GLFW_MOD_SHIFT}, daylight{GLFW_KEY_2, GLFW_MOD_SHIFT};
    run_actions(actions, std::array{daylight});
    EXPECT_TRUE(model.view.scene.lights.empty()) << "nothing is open";
    model.view.site.outline = {glm::dvec3(0), glm::dvec3(1)};
    model.view.site.box = {glm::dvec3(0), glm::dvec3(1)};
    model.view.method.engine = "direct";
    run_actions(actions, std::array{daylight});
    ASSERT_EQ(model.view.scene.lights.size(), 1u);
    EXPECT_TRUE(model.view.scene.environment);
    EXPECT_EQ(model.view.method.engine, "direct") << "the chosen engine stays";
    run_actions(actions, std::array{colours});
    EXPECT_EQ(model.view.method.engine, "unlit");
    run_actions(actions, std::array{daylight});
    EXPECT_EQ(model.view.method.engine, engine_of(Mood::daylight, SiteKind::object));
}

TEST(Actions, MoodsOfPreparedRoomsAreShownByTheirLightPaths) {
    ViewModel model(10);
    const auto actions = bound_actions(model);
    const KeyChord daylight{GLFW_KEY_2, GLFW_MOD_SHIFT}, evening{GLFW_KEY_3, GLFW_MOD_SHIFT};
    model.view.site.kind = SiteKind::interior;
    model.view.site.outline = {glm::dvec3(0), glm::dvec3(1)};
    model.view.site.box = {glm::dvec3(0), glm::dvec3(1)};
    model.view.method.engine = "paths";
    run_actions(actions, std::array{daylight});
    EXPECT_EQ(model.view.method.engine, "paths") << "chosen by hand, it is still being computed";
    model.view.method.engine = "vpl";
    run_actions(actions, std::array{evening});
    EXPECT_EQ(model.view.method.engine, "vpl");
    model.view.is_prepared = true;
    run_actions(actions, std::array{daylight});
    EXPECT_EQ(model.view.method.engine, "paths");
    run_actions(actions, std::array{evening});
    EXPECT_EQ(model.view.method.engine, "paths");
    model.view.method.engine = "micro";
    run_actions(actions, std::array{daylight});
    EXPECT_EQ(model.view.method.engine, "micro") << "the chosen engine stays";
}

class PreparingLight : public testing::Test {
 protected:
    PreparingLight() {
        model_.view.site.kind = SiteKind::interior;
        model_.view.site.outline = {glm::dvec3(0), glm::dvec3(1)};
        model_.view.method.engine = "vpl";
        model_.view.preset = "interactive";
        model_.lights.mood = Mood::evening;
        model_.lights.preparation.points = 1'000'000;
        tell({});
    }
    /// Shows a picture with these figures.
    void tell(const FrameStats& stats) {
        auto picture = std::make_shared<Picture>();
        picture->stats = stats;
        model_.view.picture = picture;
        take_progress(lighting(), {stats.prepared.value_or(0), ""});
        follow_preparing(lighting());
    }
    void run(const std::string& name) {
        for (const BoundAction& action : bound_actions(model_))
            if (action.name == name && action.enabled()) action.run();
    }
    Lighting lighting() { return model_.lighting(); }
    std::string why_not() { return why_not_prepared(lighting()); }
    std::string& engine() { return model_.view.method.engine; }
    FrameStats at(double share) const {
        FrameStats stats;
        stats.prepares_again = model_.lights.preparation.asked;
        stats.prepared = share;
        stats.prepared_for = prepared_engine();
        return stats;
    }
    const std::string begin_ = "Prepare light in advance", stop_ = "Stop preparing";
    ViewModel model_{10};
};

TEST_F(PreparingLight, SaysBeforeWhatItCostsAndWhyItCannotRun) {
    EXPECT_EQ(why_not(), "");
    EXPECT_THAT(preparing_cost(lighting()), testing::MatchesRegex("Takes about .* s on .* of memory .*"));
    model_.lights.preparation.grows = true;
    EXPECT_THAT(why_not(), testing::HasSubstr("converted"));
    run(begin_);
    EXPECT_FALSE(is_preparing(lighting()));
    model_.lights.preparation.grows = false;
    model_.view.site.kind = SiteKind::object;
    EXPECT_THAT(why_not(), testing::HasSubstr("rooms"));
    model_.view.site.inside.emplace();
    model_.view.entered = true;
    EXPECT_EQ(why_not(), "") << "in the house";
    model_.view.is_prepared = true;
    EXPECT_THAT(why_not(), testing::HasSubstr("is prepared"));
    model_.view.picture.reset();
    EXPECT_NE(why_not(), "");
}

TEST_F(PreparingLight, ShowsWhatIsThereMeanwhileAndStopsWithTheEngineOfBefore) {
    run(stop_);
    EXPECT_EQ(engine(), "vpl");
    run(begin_);
    EXPECT_EQ(engine(), "paths");
    EXPECT_EQ(engine_to_prepare(lighting()), "paths");
    tell(at(.4));
    EXPECT_TRUE(is_preparing(lighting()));
    run("Scan colours");
    EXPECT_EQ(engine(), "unlit");
    EXPECT_EQ(engine_to_prepare(lighting()), "paths") << "it goes on";
    run("Evening");
    engine() = "paths";
    run(stop_);
    EXPECT_EQ(engine(), "vpl");
    EXPECT_EQ(engine_to_prepare(lighting()), "");
    EXPECT_THAT(model_.view.message, testing::HasSubstr("Stopped at 40 %"));
    EXPECT_FALSE(is_preparing(lighting()));
    EXPECT_EQ(why_not(), "") << "it can go on";
}

TEST_F(PreparingLight, SaysAfterwardsWhatThereIsAndWhere) {
    const test::TemporaryFolder folder;
    const std::string file = folder / "scan.luc.paths.bake";
    std::ofstream(file) << std::string(2'000'000, ' ');
    run(begin_);
    FrameStats done = at(1);
    done.prepared_file = file;
    tell(done);
    EXPECT_FALSE(is_preparing(lighting()));
    EXPECT_TRUE(model_.view.is_prepared);
    EXPECT_EQ(engine_to_prepare(lighting()), "");
    const std::string state = prepared_state(lighting());
    EXPECT_THAT(state, testing::AllOf(testing::HasSubstr(file), testing::HasSubstr("1.9 MiB"))) << state;
    EXPECT_EQ(engine(), "paths");
}

TEST_F(PreparingLight, WhatCannotBeKeptStaysUntilTheWindowIsClosedAndAFailureGivesTheOldEngineBack) {
    run(begin_);
    FrameStats unkept = at(1);
    unkept.not_kept = "the disk is full";
    tell(unkept);
    EXPECT_TRUE(model_.view.is_prepared);
    EXPECT_EQ(engine_to_prepare(lighting()), "paths") << "else it would be lost";
    EXPECT_THAT(prepared_state(lighting()), testing::HasSubstr("the disk is full"));
    model_.view.is_prepared = false;
    engine() = "micro";
    run(begin_);
    EXPECT_EQ(engine(), "micro") << "chosen by hand";
    engine() = "vpl";
    run(stop_);
    run(begin_);
    FrameStats failed = at(.2);
    failed.not_prepared = "a node cannot be read";
    tell(failed);
    EXPECT_EQ(engine(), "vpl");
    EXPECT_FALSE(is_preparing(lighting()));
    EXPECT_EQ(model_.view.message, "a node cannot be read");
}

TEST_F(PreparingLight, StopsWhereAFileOfOtherOptionsWasFound) {
    begin_preparation(lighting(), {.points = 1'000'000, .file = "scan.luc.paths.bake"});
    engine() = "unlit";
    run("Evening");
    EXPECT_EQ(engine(), "paths");
    tell(at(.4));
    ASSERT_TRUE(is_preparing(lighting()));
    run(stop_);
    EXPECT_EQ(engine(), "vpl");
    EXPECT_FALSE(is_preparing(lighting()));
    EXPECT_EQ(why_not(), "") << "the button is there again";
    EXPECT_EQ(prepared_state(lighting()), "");
}

TEST_F(PreparingLight, AFailureOfTheEngineThatWasChosenByHandGivesWayToThatOfTheMood) {
    engine() = "paths";
    FrameStats failed = at(.2);
    failed.not_prepared = "a node cannot be read";
    tell(failed);
    ASSERT_EQ(why_not(), "");
    run(begin_);
    tell(failed);
    EXPECT_TRUE(is_preparing(lighting())) << "that picture was begun before";
    failed.prepares_again = at(0).prepares_again;
    tell(failed);
    EXPECT_FALSE(is_preparing(lighting()));
    EXPECT_EQ(engine(), "vpl");
}

TEST_F(PreparingLight, TheTimeThatIsLeftCountsOnlyWhatWasDoneSince) {
    run(begin_);
    tell(at(0));
    tell(at(.6));
    EXPECT_EQ(preparing_progress(lighting()), "60 %") << "it was restored";
    tell(at(.7));
    EXPECT_THAT(preparing_progress(lighting()), testing::MatchesRegex("70 %, about .* left"));
    tell(at(0));
    tell(at(.3));
    EXPECT_EQ(preparing_progress(lighting()), "30 %") << "another began";
    tell(at(.9));
    take_progress(lighting(), {1, "", true});
    EXPECT_EQ(preparing_progress(lighting()), "100 %, ends with the next picture");
}

TEST_F(PreparingLight, NamesOnlyAFileThatHoldsItAndItsPresentSize) {
    const test::TemporaryFolder folder;
    const std::string file = folder / "scan.luc.paths.bake";
    std::ofstream(file) << std::string(2'000'000, ' ');
    begin_preparation(lighting(), {.points = 1'000'000, .file = file});
    engine() = "paths";
    tell(at(.4));
    std::ofstream(file) << std::string(4'000'000, ' ');
    FrameStats done = at(1);
    done.prepared_file = file;
    tell(done);
    EXPECT_THAT(prepared_state(lighting()), testing::HasSubstr("3.8 MiB"));
    tell(at(.4));
    done.not_kept = "the disk is full";
    tell(done);
    EXPECT_THAT(prepared_state(lighting()), testing::Not(testing::HasSubstr(file)));
    EXPECT_EQ(engine_to_prepare(lighting()), "paths") << "else it would be lost";
}

TEST_F(PreparingLight, SaysWhatIsKeptOnlyWhereItIs) {
    const test::TemporaryFolder folder;
    const std::string file = folder / "scan.luc.paths.bake";
    const auto stop_with = [&](double kept) {
        if (kept > 0) {
            EXPECT_TRUE(gi::write_bake(file, {{"paths", 7, 1, kept}, {}}));
        }
        model_.lights.preparation.place = file;
        run(begin_);
        tell(at(.5));
        run(stop_);
        return model_.view.message;
    };
    EXPECT_EQ(stop_with(0), "Stopped at 50 %");
    EXPECT_THAT(stop_with(.5), testing::HasSubstr("continues"));
    EXPECT_EQ(stop_with(1), "Stopped at 50 %");
    EXPECT_THAT(what_stopping_keeps(lighting()), testing::HasSubstr("Nothing"));
}

TEST_F(PreparingLight, ReadsWhatIsKeptOnceForEachNewsOfIt) {
    const test::TemporaryFolder folder;
    const std::string file = folder / "scan.luc.paths.bake";
    ASSERT_TRUE(gi::write_bake(file, {{"paths", 7, 1, .5}, {}}));
    model_.lights.preparation.place = file;
    run(begin_);
    tell(at(.5));
    EXPECT_THAT(what_stopping_keeps(lighting()), testing::HasSubstr("are kept"));
    ASSERT_TRUE(gi::write_bake(file, {{"paths", 7, 2, 1}, {}}));
    tell(at(.5));
    EXPECT_THAT(what_stopping_keeps(lighting()), testing::HasSubstr("are kept")) << "nothing is read";
    tell(at(.6));
    EXPECT_THAT(what_stopping_keeps(lighting()), testing::HasSubstr("Nothing"));
}

TEST(Actions, GoingIntoAHouseLightsItsRoomsAndGoingOutTheHouse) {
    ImGui::CreateContext();  // the first views fit the window
    ImGui::GetIO().DisplaySize = ImVec2(400, 300);
    ViewModel model(10);
    Site& site = model.view.site;
    site.kind = SiteKind::object;
    site.box = {glm::dvec3(0), glm::dvec3(10, 10, 3)};
    site.outline = {site.box[0], site.box[1]};
    site.inside.emplace();
    site.inside->eye = {5, 5, 1.6};
    site.inside->lamps = {{5, 5, 2.5}};
    model.view.method.engine = "vpl";
    const auto actions = bound_actions(model);
    const auto run = [&](const std::string& name) {
        for (const BoundAction& action : actions)
            if (action.name == name) action.run();
    };
    run("Evening");
    ASSERT_EQ(model.view.scene.lights.size(), 1u);
    EXPECT_EQ(model.view.scene.lights[0].kind, gi::LightKind::directional) << "a low sun";
    EXPECT_EQ(model.view.method.engine, "environment");
    run("Go inside");
    ASSERT_EQ(model.view.scene.lights.size(), 1u);
    EXPECT_EQ(model.view.scene.lights[0].kind, gi::LightKind::disc) << "a lamp";
    EXPECT_EQ(model.view.method.engine, "vpl");
    EXPECT_TRUE(model.view.inside());
    model.lights.mood.reset();  // as when a light is changed
    model.view.scene.lights[0].position.z = 1;
    const auto own = model.view.scene.lights;
    run("Go inside");
    EXPECT_EQ(model.view.scene.lights, own);
    model.lights.mood = Mood::evening;
    model.view.picture = std::make_shared<Picture>();
    run("Go outside");
    EXPECT_EQ(model.view.scene.lights[0].kind, gi::LightKind::directional);
    EXPECT_EQ(model.view.method.engine, "environment");
    ImGui::DestroyContext();
}

TEST(Actions, GoInsideIsOnlyPossibleWhereARoomOrGroundWasFound) {
    ImGui::CreateContext();  // the picture's free part depends on the size of its texts
    ViewModel model(10);
    for (const BoundAction& action : bound_actions(model)) {
        if (std::string(action.name) != "Go inside") continue;
        EXPECT_FALSE(action.enabled());
        model.view.site.inside.emplace();
        EXPECT_TRUE(action.enabled());
        model.view.site.inside.reset();
        model.view.site.kind = SiteKind::terrain;
        model.view.site.box = {glm::dvec3(0), glm::dvec3(100, 100, 8)};
        model.view.site.outline = {{10, 20, 8}, {90, 80, 0}};
        ASSERT_TRUE(action.enabled()) << "on the ground";
        action.run();
        EXPECT_FALSE(model.view.inside());
        ImGui::DestroyContext();
        return;
    }
    FAIL() << "there is no such action";
}

}  // namespace
}  // namespace lucarne::viewer
