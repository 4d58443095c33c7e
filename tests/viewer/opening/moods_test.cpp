#include "viewer/opening/moods.h"

#include <cmath>
#include <numbers>
#include <vector>

#include <glm/geometric.hpp>
#include <gtest/gtest.h>

#include "gi/scene/photometry.h"
#include "gi/scene/scene_lights.h"
#include "tests/viewer/opening/sites.h"
#include "viewer/opening/first_view.h"

namespace lucarne::viewer {
namespace {

using namespace sites;

TEST(Moods, EveryMoodLightsEveryKindOfSite) {
    const Site sites[] = {room(), survey_site(terrain(20000), {dvec3(0, 0, -20), dvec3(400, 400, 20)}, 1)};
    for (const Site& site : sites)
        for (const MoodInfo& info : moods()) {
            gi::Scene scene = gi::default_scene(site.box[0], site.box[1]);
            set_mood(scene, info.mood, site, first_view(site, {}));
            EXPECT_FALSE(scene.lights.empty()) << info.name;
            for (const gi::SceneLight& light : scene.lights) {
                EXPECT_GT(light.strength.x, 0) << info.name;
                EXPECT_TRUE(std::isfinite(length(light.position)));
            }
            const auto again = gi::parse_scene(gi::write_scene(scene), "mood.json");
            ASSERT_TRUE(again) << again.error().line();
            EXPECT_EQ(again->lights.size(), scene.lights.size());
            ASSERT_TRUE(find_mood(info.name));
        }
    EXPECT_FALSE(find_mood("gloom"));
    EXPECT_EQ(usual_mood(sites[0]), Mood::evening);
    EXPECT_EQ(usual_mood(sites[1]), Mood::daylight);
}

TEST(Moods, ScansWithoutColoursShowTheirShape) {
    const Site site = room();
    gi::Scene scene;
    set_mood(scene, Mood::scan_colours, site, first_view(site, {}));
    EXPECT_EQ(scene.look.unlit.shading, gi::Shading::occlusion);
    Site grey = site;
    grey.coloured = false;
    set_mood(scene, Mood::scan_colours, grey, first_view(grey, {}));
    EXPECT_EQ(scene.look.unlit.shading, gi::Shading::relief);
}

TEST(Moods, RoomsWhoseLightPathsAreKnownAreShownByThem) {
    for (const MoodInfo& info : moods()) {
        const bool is_lit = info.mood != Mood::scan_colours;
        EXPECT_EQ(engine_of(info.mood, SiteKind::interior, true), is_lit ? "paths" : "unlit") << info.name;
        EXPECT_NE(engine_of(info.mood, SiteKind::interior), "paths") << info.name;
        EXPECT_EQ(engine_of(info.mood, SiteKind::object, true), engine_of(info.mood, SiteKind::object));
    }
    EXPECT_TRUE(shows_moods("paths", SiteKind::interior, true));
    EXPECT_FALSE(shows_moods("paths", SiteKind::object, true)) << "outside it was chosen by a person";
    EXPECT_FALSE(shows_moods("paths", SiteKind::interior)) << "whoever chose it waits for it";
    for (const bool is_prepared : {false, true}) {
        EXPECT_TRUE(shows_moods("vpl", SiteKind::interior, is_prepared))
            << "and changes when the paths are known";
        EXPECT_FALSE(shows_moods("micro", SiteKind::interior, is_prepared));
    }
}

TEST(Moods, RakingLightStandsBesideAWallAndGrazesIt) {
    const Site site = room();
    gi::Scene scene = gi::default_scene(site.box[0], site.box[1]);
    set_mood(scene, Mood::raking_light, site, first_view(site, {}));
    ASSERT_EQ(scene.lights.size(), 1u);
    for (const gi::SceneLight& light : scene.lights) {
        const dvec3 along = normalize(light.target - light.position);
        bool grazes = false;  // a wall within 1.7 m, by less than 20 degrees
        for (int axis = 0; axis < 2; ++axis)
            for (int side = 0; side < 2; ++side) {
                const double away = std::abs(light.position[axis] - kRoom[side][axis]);
                EXPECT_GT(away, .1);
                grazes |= away < 1.7 && std::abs(along[axis]) < .35;
            }
        EXPECT_TRUE(grazes);
        EXPECT_GT(length(light.target - light.position), 3) << "across most of the wall";
    }
}

TEST(Moods, DaylightComesThroughTheWindowsOfARoom) {
    std::vector<dvec3> points;
    add_faces(points, kRoom, 60000, true, 1);
    const dvec3 middle = (kRoom[0] + kRoom[1]) / 2.0;
    for (const int wall : {0, 1}) {  // a window 3 m wide and 1.2 m high in the middle of a long wall
        std::vector<dvec3> open;
        for (const dvec3& p : points)
            if (!(std::abs(p.x - kRoom[wall].x) < 1e-9 && std::abs(p.y - middle.y) < 1.5 &&
                  std::abs(p.z - 11.6) < .6))
                open.push_back(p);
        const Site site = survey_site(open, kRoom, 1);
        ASSERT_TRUE(site.inside && site.inside->sunward) << wall;
        const dvec3 towards = *site.inside->sunward;
        EXPECT_GT(towards.x * (wall ? 1 : -1), .5) << wall;
        EXPECT_GE(towards.z, std::sin(19.9 * std::numbers::pi / 180));
        gi::Scene scene;
        set_mood(scene, Mood::daylight, site, first_view(site, {}));
        const gi::SceneLight& sun = scene.lights.at(0);
        EXPECT_LT(glm::distance(glm::normalize(sun.position - sun.target), towards), 1e-6);
        // Somewhere the sun meets the floor in the picture.
        double lit = 0;
        for (double y = kRoom[0].y + .1; y < kRoom[1].y; y += .1)
            for (double x = kRoom[0].x + .1; x < kRoom[1].x; x += .1) {
                const dvec3 at(x, y, kRoom[0].z);
                const dvec3 there = at + towards * ((kRoom[wall].x - x) / towards.x);
                lit += std::abs(there.y - middle.y) < 1.5 && std::abs(there.z - 11.6) < .6;
            }
        EXPECT_GT(lit * .01, .5) << "m2";
    }
    EXPECT_FALSE(room().inside->sunward) << "no window";
}

TEST(Moods, OnlyClayHidesTheScansColours) {
    const Site site = room();
    gi::Scene scene = gi::default_scene(site.box[0], site.box[1]);
    set_mood(scene, Mood::clay, site, first_view(site, {}));
    EXPECT_EQ(scene.look.colour, gi::ColourBy::clay);
    for (const Mood next : {Mood::scan_colours, Mood::evening}) {
        scene.look.colour = gi::ColourBy::clay;
        set_mood(scene, next, site, first_view(site, {}));
        EXPECT_EQ(scene.look.colour, gi::ColourBy::colour);
    }
    scene.look.colour = gi::ColourBy::elevation;
    set_mood(scene, Mood::museum, site, first_view(site, {}));
    EXPECT_EQ(scene.look.colour, gi::ColourBy::elevation) << "what the user has chosen stays";
}

TEST(Moods, TheHourMovesAndReddensTheSun) {
    const Site site = survey_site(terrain(20000), {dvec3(0, 0, -20), dvec3(400, 400, 20)}, 1);
    gi::Scene scene = gi::default_scene(site.box[0], site.box[1]);
    set_mood(scene, Mood::daylight, site, first_view(site, {}));
    ASSERT_TRUE(scene.environment && scene.environment->sky);
    gi::SunMoment moment;
    const auto at = [&](int hour) {
        gi::LocalTime time = gi::local_time(moment.time);
        time.seconds = hour * 3600;
        moment.time = gi::moment_of(time, moment.time.ahead);
        set_daytime(scene, moment);
        return scene.lights.front();
    };
    const gi::SceneLight noon = at(13), evening = at(20);
    EXPECT_GT(normalize(noon.position - noon.target).z, .9) << "Vienna at midsummer";
    EXPECT_LT(normalize(evening.position - evening.target).z, .2);
    EXPECT_GT(evening.strength.x / evening.strength.z, 1.5 * noon.strength.x / noon.strength.z);
    const float dusk = scene.environment->radiance({0, 0, 1}).z;
    EXPECT_FALSE(shines(at(0))) << "midnight";
    const float night = scene.environment->radiance({0, 0, 1}).z;
    EXPECT_GT(night, 0) << "some light is left";
    EXPECT_LT(night, .01f * dusk);
    EXPECT_EQ(at(13), noon) << "the way does not matter";
}

/// What a white surface in the open leaves, as it is shown: sun and sky over the scene's white.
dvec3 shown(const gi::Scene& scene, const dvec3& normal) {
    const gi::SceneLight& sun = scene.lights.at(0);
    const double cosine = dot(normalize(sun.position - sun.target), normal);
    dvec3 light = sun.strength * std::max(cosine, 0.0);
    constexpr int kSteps = 40;
    for (int i = 0; i < kSteps; ++i)
        for (int j = 0; j < 4 * kSteps; ++j) {  // equal areas of the upper hemisphere
            const double z = (i + .5) / kSteps, turn = 2 * std::numbers::pi * (j + .5) / (4 * kSteps);
            const double r = std::sqrt(1 - z * z);
            const dvec3 from(r * std::cos(turn), r * std::sin(turn), z);
            light += dvec3(scene.environment->radiance(glm::vec3(from))) * std::max(dot(from, normal), 0.0) *
                     (2 * std::numbers::pi / (4 * kSteps * kSteps));
        }
    return light / scene.white;
}

TEST(Moods, EveningIsWarmWhereTheSunShinesAndNotNightElsewhere) {
    const std::vector<dvec3> ground = terrain(20000);
    std::vector<dvec3> statue;
    add_faces(statue, {dvec3(0), dvec3(.6, .6, 1.8)}, 20000, true, 9);
    const Site sites[] = {survey_site(ground, {dvec3(0, 0, -20), dvec3(400, 400, 20)}, 1),
                          survey_site(statue, {dvec3(0), dvec3(.6, .6, 1.8)}, 1)};
    for (const Site& site : sites) {
        const gi::SceneCamera camera = first_view(site, {});
        gi::Scene scene = gi::default_scene(site.box[0], site.box[1]);
        set_mood(scene, Mood::evening, site, camera);
        const gi::SceneLight& sun = scene.lights.at(0);
        const dvec3 towards = normalize(sun.position - sun.target);
        EXPECT_LT(towards.z, .2);
        const dvec3 back = camera.position - camera.target;
        EXPECT_GT(dot(towards, normalize(dvec3(back.x, back.y, 0))), .3) << "the camera sees what is lit";
        const dvec3 wall = shown(scene, normalize(dvec3(towards.x, towards.y, 0))),
                    floor = shown(scene, {0, 0, 1});
        EXPECT_GT(wall.x, 1.3 * wall.z);
        EXPECT_LT(floor.z, 1.3 * floor.x);
        EXPECT_GT(wall.y, 1.5 * floor.y) << "low light";
    }
}

}  // namespace
}  // namespace lucarne::viewer
