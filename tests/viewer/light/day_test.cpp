#include "viewer/light/day.h"

#include <cmath>

#include <glm/geometric.hpp>
#include <gtest/gtest.h>

#include "viewer/opening/moods.h"

namespace lucarne::viewer {
namespace {

gi::SunMoment vienna(int second) {
    gi::SunMoment moment;
    gi::LocalTime time = gi::local_time(moment.time);
    time.seconds = second;
    moment.time = gi::moment_of(time, moment.time.ahead);
    return moment;
}

TEST(SunDial, ShowsTheSunWhereItStands) {
    const SunOnDial morning = on_dial(vienna(7 * 3600)), noon = on_dial(vienna(13 * 3600)),
                    evening = on_dial(vienna(19 * 3600)), night = on_dial(vienna(0));
    EXPECT_GT(morning.place.x, .5) << "in the east";
    EXPECT_GT(noon.place.y, .2) << "in the south, 65 degrees high";
    EXPECT_LT(glm::length(noon.place), .35);
    EXPECT_LT(evening.place.x, -.5);
    EXPECT_GT(glm::length(night.place), 1) << "below the horizon";
    EXPECT_NEAR(glm::length(noon.place), (90 - noon.elevation) / 90, 1e-12);
}

TEST(SunDial, DraggingChoosesTheNearestTimeOfTheSameDay) {
    const auto day = day_on_dial(vienna(13 * 3600));
    ASSERT_EQ(day.size(), 144u);
    for (const int second : {6 * 3600, 9 * 3600 + 600, 17 * 3600}) {
        const SunOnDial* found = nearest_on_dial(day, on_dial(vienna(second)).place);
        ASSERT_TRUE(found);
        EXPECT_EQ(found->moment, vienna(second));
    }
    EXPECT_EQ(nearest_on_dial({}, {0, 0}), nullptr);
}

TEST(DayFilm, LeavesTheNightOut) {
    EXPECT_EQ(*later_that_day(vienna(12 * 3600), 600), vienna(12 * 3600 + 600));
    const auto morning = later_that_day(vienna(21 * 3600 + 40 * 60), 600);
    ASSERT_TRUE(morning);
    const gi::LocalTime time = gi::local_time(morning->time), date = gi::local_time(vienna(0).time);
    EXPECT_GT(time.seconds, 3 * 3600);
    EXPECT_LT(time.seconds, 6 * 3600);
    EXPECT_EQ(time.day, date.day) << "the film stays on its day";
    gi::SunMoment polar = vienna(12 * 3600);
    polar.latitude = -80;
    EXPECT_FALSE(later_that_day(polar, 600));
}

TEST(DayFilm, MovesTheSunOfTheSceneUntilItIsStopped) {
    View view(10);
    LightModel lights;
    const Lighting model{view, lights};
    play_day(model);
    EXPECT_FALSE(lights.plays_day) << "there is no sun";
    view.site.outline = {glm::dvec3(0), glm::dvec3(10)};
    view.site.box = {glm::dvec3(0), glm::dvec3(10)};
    set_mood(view.scene, Mood::daylight, view.site, view.rig.camera());
    set_daytime(view.scene, vienna(10 * 3600));
    play_day(model);
    ASSERT_TRUE(lights.plays_day);
    const uint64_t version = view.scene_version;
    advance_day(model, .2);
    EXPECT_EQ(*moment_of_sun(view.scene), vienna(10 * 3600 + 360));
    EXPECT_GT(view.scene_version, version);
    EXPECT_TRUE(view.scene.environment->sky) << "the sky is that of the hour";
    advance_day(model, 1000);
    EXPECT_EQ(*moment_of_sun(view.scene), vienna(10 * 3600 + 360 + 450)) << "a pause makes no leap";
    play_day(model);
    advance_day(model, .2);
    EXPECT_EQ(*moment_of_sun(view.scene), vienna(10 * 3600 + 810));
    play_day(model);
    view.scene.lights.clear();
    advance_day(model, .2);
    EXPECT_FALSE(lights.plays_day);
}

TEST(DayFilm, EndsWhereTheSunDoesNotRise) {
    View view(10);
    LightModel lights;
    const Lighting model{view, lights};
    gi::SceneLight sun;
    sun.kind = gi::LightKind::directional;
    sun.sun = vienna(12 * 3600);
    sun.sun->latitude = -85;
    view.scene.lights = {sun};
    play_day(model);
    advance_day(model, .1);
    EXPECT_FALSE(lights.plays_day);
    EXPECT_FALSE(view.message.empty());
}

}  // namespace
}  // namespace lucarne::viewer
