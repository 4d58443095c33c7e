#include <algorithm>
#include <cmath>

#include <glm/geometric.hpp>
#include <gtest/gtest.h>

#include "tests/viewer/program.h"
#include "viewer/light/edits.h"
#include "viewer/light/handles.h"
#include "viewer/overlay/figure_scale.h"
#include "viewer/ui/scene_file.h"

namespace lucarne::viewer {
namespace {

using glm::dvec3;
using Part = LightHandle::Part;

gi::SceneLight light_of(gi::LightKind kind) {
    gi::SceneLight light;
    light.kind = kind;
    light.position = {0, 0, 5};
    light.target = {0, 0, 0};
    return light;
}

/// A view, its lights and its scene file.
struct LitView {
    View view{10};
    LightModel lights;
    SceneFile scene_file;
    Lighting lighting() { return {view, lights}; }
};

TEST(LightEdits, AddCopyAndDelete) {
    LitView model;
    add_light(model.lighting(), gi::LightKind::spot);
    ASSERT_EQ(model.view.scene.lights.size(), 1u);
    EXPECT_GT(model.view.scene.lights[0].strength.x, 0);
    const auto one = model.view.scene.lights;
    duplicate_light(model.lighting());
    ASSERT_EQ(model.view.scene.lights.size(), 2u);
    EXPECT_EQ(model.lights.selected, 1u);
    EXPECT_NE(model.view.scene.lights[1].position, model.view.scene.lights[0].position);
    remove_light(model.lighting());
    EXPECT_EQ(model.view.scene.lights, one);
    remove_light(model.lighting());
    EXPECT_TRUE(model.view.scene.lights.empty());
    remove_light(model.lighting());
    switch_selected_light(model.lighting());
    EXPECT_TRUE(model.view.scene.lights.empty());
}

TEST(LightEdits, AMoodBringsItsEngineUnlessAnotherWasChosenByHand) {
    LitView model;
    model.view.site.outline = {dvec3(0), dvec3(10)};
    model.view.site.box = {dvec3(0), dvec3(10)};
    std::string& engine = model.view.method.engine;
    engine = "unlit";
    take_mood(model.lighting(), Mood::daylight);
    EXPECT_EQ(engine, "environment") << "the tests' machines have OpenCL";
    take_mood(model.lighting(), Mood::museum);
    EXPECT_EQ(engine, "vpl");
    engine = "micro";
    take_mood(model.lighting(), Mood::daylight);
    EXPECT_EQ(engine, "micro");
    take_mood(model.lighting(), Mood::scan_colours);
    EXPECT_EQ(engine, "unlit");
}

TEST(LightEdits, TheHourThatWasChosenStaysWhenTheLightIsMadeAnew) {
    LitView model;
    model.view.site.outline = {dvec3(0), dvec3(10)};
    model.view.site.box = {dvec3(0), dvec3(10)};
    take_mood(model.lighting(), Mood::daylight);
    EXPECT_FALSE(model.view.scene.lights.front().sun);
    gi::SunMoment moment;
    moment.latitude = 10;
    set_daytime(model.view.scene, moment);
    gi::SkySettings hazy;
    hazy.turbidity = 5;
    set_clear_sky(model.lighting(), hazy);
    const auto chosen = model.view.scene.lights;
    light_for_place(model.lighting());
    ASSERT_TRUE(model.view.scene.lights.front().sun);
    EXPECT_EQ(model.view.scene.lights.front().sun->latitude, 10);
    EXPECT_EQ(model.view.scene.lights.front().strength, chosen.front().strength);
    EXPECT_EQ(model.view.scene.environment->sky->turbidity, 5);
}

TEST(LightEdits, TheSkyFollowsTheSunHoweverThatIsMoved) {
    LitView model;
    add_light(model.lighting(), gi::LightKind::directional);
    gi::SceneLight& sun = model.view.scene.lights.front();
    set_clear_sky(model.lighting(), {});
    const auto sky_sun = [&] { return model.view.scene.environment->sky->sun; };
    const auto to_sun = [&] { return glm::normalize(sun.position - sun.target); };
    EXPECT_TRUE(sun.daylight) << "sun and sky agree";
    EXPECT_LT(glm::distance(sky_sun(), to_sun()), 1e-9);
    set_sun(model.lighting(), gi::SunMoment{});
    EXPECT_LT(glm::distance(sky_sun(), to_sun()), 1e-9);
    const dvec3 noon = sun.strength;
    gi::SunMoment later;
    later.time.seconds += 8 * 3600;
    set_sun(model.lighting(), later);
    EXPECT_LT(glm::distance(sky_sun(), to_sun()), 1e-9);
    EXPECT_LT(sun.strength.y, .7 * noon.y);
    move_light(sun, Part::sky, {-1, 0, .1}, LightSphere{});
    model.view.scene_changed();
    EXPECT_LT(sky_sun().x, -.9);
    sun.daylight = false;
    sun.strength = dvec3(5);
    gi::SkySettings hazy;
    hazy.turbidity = 6;
    set_clear_sky(model.lighting(), hazy);
    EXPECT_EQ(sun.strength, dvec3(5)) << "the user's own strength stays";
    EXPECT_EQ(model.view.scene.environment->sky->turbidity, 6);
    remove_light(model.lighting());
    ASSERT_TRUE(model.view.scene.environment);
    EXPECT_LT(sky_sun().x, -.9) << "the sky stays when its sun has gone";
    EXPECT_TRUE(gi::parse_scene(gi::write_scene(model.view.scene), "sky.json"));
}

TEST(LightEdits, ASceneHoldsNoMoreLightsThanItsFileMay) {
    LitView model;
    for (int i = 0; i < 80; ++i) add_light(model.lighting(), gi::LightKind::point);
    for (int i = 0; i < 3; ++i) duplicate_light(model.lighting());
    EXPECT_EQ(model.view.scene.lights.size(), 64u);
    EXPECT_TRUE(gi::parse_scene(gi::write_scene(scene_to_save(model.view)), "full.json"));
}

TEST(LightEdits, EveryKindThatIsAddedIsReadBackFromTheSavedScene) {
    LitView model;
    for (uint32_t kind = 0; kind < 5; ++kind) add_light(model.lighting(), static_cast<gi::LightKind>(kind));
    model.lights.selected = 2;
    set_sun(model.lighting(), gi::SunMoment{});
    switch_selected_light(model.lighting());
    const test::TemporaryFolder folder;
    model.scene_file.set_path(folder / "saved.json");
    model.scene_file.save(model.view);
    EXPECT_EQ(model.view.message, "saved " + (folder / "saved.json"));
    const auto saved = gi::load_scene(folder / "saved.json");
    ASSERT_TRUE(saved) << saved.error().line();
    EXPECT_EQ(saved->lights, model.view.scene.lights);
    EXPECT_FALSE(saved->lights[2].on);
    ASSERT_EQ(saved->cameras.size(), 1u);
    EXPECT_EQ(saved->cameras[0].name, "view");
    EXPECT_LT(glm::distance(saved->cameras[0].position, model.view.rig.position()), 1e-9);
}

TEST(LightEdits, SavingAgainReplacesTheViewAndNotTheFileOfAnother) {
    const test::TemporaryFolder folder;
    LitView model;
    model.view.pictures = folder.path();
    model.scene_file.save(model.view);
    model.scene_file.save(model.view);
    LitView other;
    other.view.pictures = folder.path();
    other.scene_file.save(other.view);
    EXPECT_TRUE(std::filesystem::exists(folder / "scene-0001.json"));
    EXPECT_TRUE(std::filesystem::exists(folder / "scene-0002.json"));
    EXPECT_FALSE(std::filesystem::exists(folder / "scene-0003.json"));
}

TEST(LightEdits, WhatIsOnlyShownOtherwiseIsNoMove) {
    LitView model;
    const uint64_t moves = model.view.scene_version - model.view.shown_changes;
    model.view.shown_changed();
    EXPECT_EQ(model.view.scene_version - model.view.shown_changes, moves);
    model.view.scene_changed();
    EXPECT_NE(model.view.scene_version - model.view.shown_changes, moves);
}

TEST(LightHandles, AreWhereALightStandsAndWhatItShinesAt) {
    EXPECT_EQ(light_handles({light_of(gi::LightKind::spot), light_of(gi::LightKind::point),
                             light_of(gi::LightKind::directional)}),
              (std::vector<LightHandle>{
                  {Part::position, 0}, {Part::target, 0}, {Part::position, 1}, {Part::sky, 2}}));
}

TEST(LightHandles, AreDraggedParallelToThePicture) {
    const gi::SceneLight spot = light_of(gi::LightKind::spot);
    const dvec3 eye(0, -10, 5), forward(0, 1, 0);
    const auto to = dragged_place(spot, Part::position, {}, eye, {0.2, 1, 0.1}, forward);
    ASSERT_TRUE(to);
    EXPECT_LT(glm::distance(*to, dvec3(2, 0, 6)), 1e-12);
    EXPECT_FALSE(dragged_place(spot, Part::position, {}, {0, 10, 5}, forward, forward))
        << "it is behind the eye";
}

TEST(LightHandles, ASunIsDraggedAboutTheSceneAndForgetsItsTime) {
    gi::SceneLight sun = light_of(gi::LightKind::directional);
    sun.sun.emplace();
    const LightSphere sky{{0, 0, 0}, 2};
    EXPECT_LT(glm::distance(handle_place(sun, Part::sky, sky), dvec3(0, 0, 2)), 1e-12);
    const auto to = dragged_place(sun, Part::sky, sky, {1, -10, 1}, {0, 1, 0}, {0, 1, 0});
    ASSERT_TRUE(to);
    EXPECT_NEAR(glm::length(*to), 2, 1e-12);
    EXPECT_TRUE(move_light(sun, Part::sky, *to, sky));
    EXPECT_FALSE(sun.sun);
    EXPECT_LT(glm::distance(handle_place(sun, Part::sky, sky), *to), 1e-12);
    const auto beside = dragged_place(sun, Part::sky, sky, {9, -10, 0}, {0, 1, 0}, {0, 1, 0});
    EXPECT_LT(glm::distance(beside.value_or(dvec3(0)), dvec3(2, 0, 0)), 1e-9);
}

TEST(LightHandles, ALightThatWouldShineNowhereStays) {
    gi::SceneLight spot = light_of(gi::LightKind::spot);
    EXPECT_FALSE(move_light(spot, Part::target, spot.position, {}));
    EXPECT_FALSE(move_light(spot, Part::position, spot.target, {}));
    EXPECT_EQ(spot, light_of(gi::LightKind::spot));
    EXPECT_TRUE(move_light(spot, Part::target, {1, 1, 1}, {}));
    EXPECT_EQ(spot.target, dvec3(1, 1, 1));
}

TEST(FigureScale, HasPowersOfTenForLuminancesAndNothingForPictures) {
    OverlayView view;
    view.size = {800, 600};
    gi::Scene scene;
    EXPECT_TRUE(figure_scale(scene, 0, view).empty());
    scene.tone_map = gi::ToneMap::false_colour;
    scene.luminance = gi::ValueRange{0.1, 10000};
    std::vector<std::string> texts;
    for (const Mark& mark : figure_scale(scene, 0, view))
        if (mark.kind == Mark::Kind::text) texts.push_back(mark.text);
    EXPECT_EQ(texts,
              (std::vector<std::string>{"luminance, cd/m2", "0.1", "1", "10", "100", "1000", "10000"}));
    scene.tone_map = gi::ToneMap::illuminance;
    const auto marks = figure_scale(scene, 0, view);
    EXPECT_TRUE(std::ranges::any_of(marks, [](const Mark& mark) { return mark.text == "illuminance, lx"; }));
}

}  // namespace
}  // namespace lucarne::viewer
