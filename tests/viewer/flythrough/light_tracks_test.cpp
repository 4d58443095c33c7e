#include "viewer/flythrough/light_tracks.h"

#include <cmath>

#include <fmt/format.h>
#include <glm/geometric.hpp>
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "viewer/flythrough/path.h"

namespace lucarne::viewer {
namespace {

using glm::dvec3;
using testing::HasSubstr;

/// A path whose camera stands still, with light tracks.
std::string path_with(const std::string& tracks) {
    return R"({"keys": [{"time": 0, "position": [0, 0, 1], "target": [0, 9, 1]},
        {"time": 10, "position": [0, 0, 1], "target": [0, 9, 1]}], )" +
           tracks + "}";
}

LightTracks tracks_of(const std::string& tracks) {
    auto path = parse_path(path_with(tracks), "path.json");
    EXPECT_TRUE(path) << path.error().line();
    return path ? std::move(path->lights) : LightTracks{};
}

gi::Scene scene_of(const char* text) {
    auto scene = gi::parse_scene(text, "scene.json");
    EXPECT_TRUE(scene) << scene.error().line();
    return scene ? std::move(*scene) : gi::Scene{};
}

gi::Scene lamps_and_sun() {
    return scene_of(R"({"lights": [
        {"type": "spot", "name": "spot", "position": [0, 0, 3], "target": [0, 0, 0], "intensity": [9, 8, 7]},
        {"type": "point", "name": "bulb", "position": [1, 1, 2], "intensity": [5, 5, 5], "on": false},
        {"type": "directional", "name": "sun", "sun": {"latitude": 48, "longitude": 0, "north": 20,
         "time": "2026-03-20T06:00:00Z"}}],
        "environment": {"sky": {"turbidity": 4}}})");
}

const gi::SceneLight& spot(const gi::Scene& scene) {
    return scene.lights[0];
}

TEST(LightTracks, ALampPassesThroughItsKeysAndRestsBetweenEqualOnes) {
    const LightTracks tracks = tracks_of(R"("lights": [{"name": "spot", "keys": [
        {"time": 0, "position": [0.1, 0, 3]}, {"time": 1, "position": [0.7, 0.3, 3]},
        {"time": 4, "position": [0.7, 0.3, 3]}, {"time": 5, "position": [2, 1, 2.2]}]}])");
    const gi::Scene base = lamps_and_sun();
    gi::Scene scene = base;
    ASSERT_TRUE(tracks.check(scene));
    const std::pair<double, dvec3> keys[] = {{-1, {.1, 0, 3}}, {0, {.1, 0, 3}},  {1, {.7, .3, 3}},
                                             {4, {.7, .3, 3}}, {5, {2, 1, 2.2}}, {9, {2, 1, 2.2}}};
    for (const auto& [time, place] : keys) {
        tracks.apply(base, time, scene);
        EXPECT_LT(glm::distance(spot(scene).position, place), 1e-12) << time;
        EXPECT_EQ(spot(scene).target, spot(base).target) << "a lamp that moves shines on the same place";
    }
    for (double time = 1; time < 4; time += .013) {
        tracks.apply(base, time, scene);
        EXPECT_EQ(spot(scene).position, dvec3(.7, .3, 3)) << "to the last bit, at " << time;
    }
    EXPECT_EQ(spot(scene).strength, spot(base).strength);
    EXPECT_EQ(scene.lights[1], base.lights[1]) << "lights without a track stay as they are";
    EXPECT_EQ(scene.lights[2], base.lights[2]);
}

TEST(LightTracks, EachQuantityHasKeysOfItsOwn) {
    const LightTracks tracks = tracks_of(R"("lights": [{"name": "bulb", "keys": [
        {"time": 0, "position": [0, 0, 2], "strength": [4, 0, 0]}, {"time": 2, "on": true},
        {"time": 4, "position": [4, 0, 2]}, {"time": 6, "strength": [0, 4, 0], "on": false}]}])");
    const gi::Scene base = lamps_and_sun();
    gi::Scene scene = base;
    ASSERT_TRUE(tracks.check(scene)) << "also of a light that is off";
    const gi::SceneLight& bulb = scene.lights[1];
    tracks.apply(base, 3, scene);
    EXPECT_LT(glm::distance(bulb.position, dvec3(3, 0, 2)), 1e-12);
    EXPECT_LT(glm::distance(bulb.strength, dvec3(2, 2, 0)), 1e-12);
    EXPECT_EQ(bulb.target, bulb.position - dvec3(0, 0, 1)) << "as of every point light";
    EXPECT_TRUE(bulb.on);
    tracks.apply(base, 6, scene);
    EXPECT_FALSE(bulb.on);
    tracks.apply(base, 2, scene);
    EXPECT_TRUE(bulb.on) << "time may run backwards";
}

TEST(LightTracks, StrengthIsNeverNegative) {
    // It falls from 8 to .1 in a second and stays near that for red: the curve goes on below zero.
    const LightTracks tracks = tracks_of(R"("lights": [{"name": "spot", "keys": [
        {"time": 0, "strength": [8, 8, 8]}, {"time": 1, "strength": [0.1, 0.1, 0.1]},
        {"time": 9, "strength": [0.2, 8, 8]}]}])");
    const gi::Scene base = lamps_and_sun();
    gi::Scene scene = base;
    double least = 1;
    for (double time = 0; time <= 9; time += .05) {
        tracks.apply(base, time, scene);
        const dvec3& strength = spot(scene).strength;
        for (int i = 0; i < 3; ++i) {
            EXPECT_GE(strength[i], 0);
            least = std::min(least, strength[i]);
        }
    }
    EXPECT_EQ(least, 0) << "it would have been";
}

TEST(LightTracks, ALampThatMeetsItsTargetHasTheScenesDirectionAndThenShinesOnTheSamePlaceAgain) {
    const LightTracks tracks = tracks_of(R"("lights": [{"name": "spot", "keys": [
        {"time": 0, "position": [0, 0, 2]}, {"time": 2, "position": [0, 0, 0]}]}])");
    const gi::Scene base = lamps_and_sun();
    gi::Scene scene = base;
    for (const double time : {1.0, 2.0, 3.0}) tracks.apply(base, time, scene);
    EXPECT_EQ(spot(scene).target - spot(scene).position, dvec3(0, 0, -1));
    tracks.apply(base, 1, scene);
    EXPECT_EQ(spot(scene).target, spot(base).target);
    gi::Scene alone = base;
    tracks.apply(base, 1, alone);
    EXPECT_EQ(scene.lights, alone.lights) << "whatever the times before were";
    // Far from the origin.
    const LightTracks far = tracks_of(R"("lights": [{"name": "spot", "keys": [
        {"time": 0, "position": [1e9, 1e9, 1e9], "target": [1e9, 1e9, 1e9]}]}])");
    far.apply(base, 0, scene);
    EXPECT_NE(spot(scene).target, spot(scene).position);
}

// Keys a moment apart followed by ones hours apart made curves that left all ranges, and then all numbers.
TEST(LightTracks, SteepKeysStayWithinTheRangesOfTheirNumbers) {
    const auto steep = parse_path(R"({"frames_per_second": 1, "keys": [
        {"time": 0, "position": [0, 0, 1], "target": [0, 9, 1], "fov": 60},
        {"time": 0.001, "position": [1e9, 0, 1], "target": [0, 9, 1], "fov": 170},
        {"time": 1e5, "position": [0, -1e9, 1], "target": [9, 9, 1], "fov": 60}],
        "lights": [{"name": "spot", "keys": [{"time": 0, "strength": [0, 0, 0], "position": [0, 0, 2]},
        {"time": 0.001, "strength": [1e12, 1, 0], "position": [1e9, 0, 2]},
        {"time": 1e5, "strength": [0, 0, 0], "position": [0, 0, 2]}]}]})",
                                  "steep.json");
    ASSERT_TRUE(steep) << steep.error().line();
    const gi::Scene base = lamps_and_sun();
    gi::Scene scene = base;
    double highest = 0;
    for (double time = 0; time < 1e5; time += 1234.5) {
        const auto camera = steep->at(time);
        steep->lights.apply(base, time, scene);
        for (int i = 0; i < 3; ++i) {
            EXPECT_LE(std::abs(camera.position[i]), 1e9);
            EXPECT_LE(std::abs(spot(scene).position[i]), 1e9);
            EXPECT_GE(spot(scene).strength[i], 0);
            EXPECT_LE(spot(scene).strength[i], 1e12);
        }
        EXPECT_LE(camera.vertical_fov, 3);
        EXPECT_GT(camera.vertical_fov, 0);
        highest = std::max(highest, camera.position.x);
    }
    EXPECT_EQ(highest, 1e9) << "it would have been far beyond";
    EXPECT_FALSE(parse_path(R"({"keys": [{"time": 0, "position": [0, 0, 1], "target": [0, 9, 1]},
        {"time": 1e-320, "position": [0, 1, 1], "target": [0, 9, 1]}]})",
                            "near.json"));
}

TEST(LightTracks, TheSunsDayRunsEvenlyAndSkyAndStrengthFollow) {
    const LightTracks tracks = tracks_of(R"("sun": [{"time": 0, "clock": "2026-03-20T06:00:00Z"},
        {"time": 10, "clock": "2026-03-20T18:00:00Z"}])");
    const gi::Scene base = lamps_and_sun();
    gi::Scene scene = base;
    ASSERT_TRUE(tracks.check(scene));
    const auto seen = [&](double time) {
        tracks.apply(base, time, scene);
        const gi::SceneLight& sun = scene.lights[2];
        return std::tuple(sun.sun->time.seconds, -glm::normalize(sun.target - sun.position), sun.strength,
                          scene.environment);
    };
    const auto [six, east, weak, morning] = seen(0);
    const auto [eleven, high, strong, noon] = seen(5);
    const auto [twelve, higher, stronger, later] = seen(6);
    EXPECT_EQ(eleven - six, 6 * 3600);
    EXPECT_EQ(twelve - eleven, 3600 + 720);
    EXPECT_GT(high.z, .6);
    EXPECT_LT(std::abs(east.z), .03) << "at the equinox the sun rises at six";
    EXPECT_GT(strong.x, 5 * weak.x + 1);
    EXPECT_NE(morning, noon) << "the sky is that of the hour";
    EXPECT_EQ(scene.environment->sky->turbidity, 4) << "the haze is the scene's";
    EXPECT_EQ(scene.lights[2].sun->latitude, 48);
    EXPECT_EQ(scene.lights[2].sun->north, 20);
    const auto sky = std::get<3>(seen(6));
    EXPECT_EQ(sky, later) << "as long as the sun stands still the sky is the same picture";
    EXPECT_NE(stronger, strong);
}

TEST(LightTracks, AreReadBackTheSame) {
    const std::string text = path_with(R"("lights": [
        {"name": "spot", "keys": [{"time": 0, "position": [0.1, 0.2, 0.3], "target": [1e-7, 1, 1]},
         {"time": 0.7, "strength": [1, 2, 3], "on": false}]},
        {"name": "two", "keys": [{"time": 3, "on": true}]}],
        "sun": [{"time": 1, "clock": "2026-06-21T04:30:05+02:00"}, {"time": 2, "clock": "2026-06-21T02:00:00Z"}])");
    const auto path = parse_path(text, "path.json");
    ASSERT_TRUE(path) << path.error().line();
    const auto again = parse_path(path_text(*path), "again.json");
    ASSERT_TRUE(again) << again.error().line();
    EXPECT_EQ(again->lights, path->lights);
    EXPECT_EQ(path->lights.lights.size(), 2u);
    EXPECT_EQ(path->lights.sun.size(), 2u);
    const auto still = parse_path(path_with(R"("frames_per_second": 2)"), "still.json");
    ASSERT_TRUE(still);
    EXPECT_THAT(path_text(*still), testing::Not(HasSubstr("sun")));
    EXPECT_TRUE(still->lights.empty());
}

TEST(LightTracks, MistakesNameTheirPlace) {
    const auto lamp = [](const std::string& keys) {
        return R"("lights": [{"name": "spot", "keys": [)" + keys + "]}]";
    };
    std::string many;
    for (int i = 0; i < 65; ++i)
        many += fmt::format(R"({}{{"name": "{}", "keys": [{{"time": 0, "on": true}}]}})", i ? ", " : "", i);
    const std::pair<std::string, const char*> cases[] = {
        {R"("lights": 3)", "/lights: must be an array"},
        {R"("lights": [{"keys": []}])", "/lights/0: the key 'name' is missing"},
        {R"("lights": [{"name": "", "keys": []}])", "/lights/0/name: names no light"},
        {R"("lights": [{"name": "spot"}])", "/lights/0/keys: must hold at least one key"},
        {R"("lights": [{"name": "spot", "keys": [{"time": 0, "on": true}], "speed": 1}])", "/lights/0/speed"},
        {lamp(R"({"on": true})"), "/lights/0/keys/0: the key 'time' is missing"},
        {lamp(R"({"time": 0})"), "/lights/0/keys/0: says nothing"},
        {lamp(R"({"time": -1, "on": true})"), "/lights/0/keys/0/time: must be a number from 0"},
        {lamp(R"({"time": 1, "on": true}, {"time": 1, "on": false})"),
         "/lights/0/keys/1/time: must be later than 1 s"},
        {lamp(R"({"time": 0, "strength": [1, 1, -1]})"), "/lights/0/keys/0/strength"},
        {lamp(R"({"time": 0, "strength": 5})"), "/lights/0/keys/0/strength: must be three numbers"},
        {lamp(R"({"time": 0, "position": [1e300, 0, 0]})"), "/lights/0/keys/0/position"},
        {lamp(R"({"time": 0, "colour": [1, 1, 1]})"), "/lights/0/keys/0/colour: is not a known key"},
        {lamp(R"({"time": 0, "on": 1})"), "/lights/0/keys/0/on"},
        {R"("lights": [{"name": "a", "keys": [{"time": 0, "on": true}]}, {"name": "a", "keys": [{"time": 0, "on": true}]}])",
         "/lights/1/name: has keys already"},
        {"\"lights\": [" + many + "]", "/lights: "},
        {R"("sun": [{"time": 0}])", "/sun/0: the key 'clock' is missing"},
        {R"("sun": [{"time": 0, "clock": "noon"}])", "/sun/0/clock"},
        {R"("sun": [{"time": 0, "clock": "1776-07-04T12:00:00Z"}])", "/sun/0/clock"},
        {R"("sun": [{"time": 2, "clock": "2026-06-21T12:00:00Z"}, {"time": 1, "clock": "2026-06-21T12:00:00Z"}])",
         "/sun/1/time: must be later than 2 s"},
    };
    for (const auto& [tracks, expected] : cases) {
        const auto path = parse_path(path_with(tracks), "path.json");
        ASSERT_FALSE(path) << tracks;
        EXPECT_EQ(path.error().kind, ErrorKind::input_rejected);
        EXPECT_THAT(path.error().line(), HasSubstr(expected));
    }
}

TEST(LightTracks, FitOnlyScenesThatHaveTheirLights) {
    const auto problem = [](const std::string& tracks, const gi::Scene& scene) {
        const auto checked = tracks_of(tracks).check(scene);
        return checked ? std::string() : checked.error().line();
    };
    const std::string lamp = R"("lights": [{"name": "lamp", "keys": [{"time": 0, "position": [0, 0, 1]}]}])";
    EXPECT_THAT(problem(lamp, lamps_and_sun()), HasSubstr("light 'lamp' of the flythrough"));
    gi::Scene twins = lamps_and_sun();
    twins.lights[0].name = twins.lights[1].name = "lamp";
    EXPECT_THAT(problem(lamp, twins), HasSubstr("several lights"));
    EXPECT_THAT(problem(R"("lights": [{"name": "sun", "keys": [{"time": 0, "position": [0, 0, 1]}]}])",
                        lamps_and_sun()),
                HasSubstr("directional"));
    EXPECT_EQ(problem(R"("lights": [{"name": "sun", "keys": [{"time": 0, "strength": [1, 1, 1]}]}])",
                      lamps_and_sun()),
              "");
    gi::Scene dark = lamps_and_sun();
    dark.lights.pop_back();
    EXPECT_THAT(problem(R"("sun": [{"time": 0, "clock": "2026-06-21T12:00:00Z"}])", dark),
                HasSubstr("no sun"));
}

}  // namespace
}  // namespace lucarne::viewer
