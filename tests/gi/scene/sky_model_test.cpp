#include "gi/scene/sky_model.h"

#include <algorithm>
#include <cmath>

#include <glm/geometric.hpp>
#include <glm/trigonometric.hpp>
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "gi/scene/photometry.h"
#include "gi/scene/scene_lights.h"

namespace lucarne::gi {
namespace {

using glm::dvec3;
using testing::HasSubstr;

/// A sky whose sun stands at an elevation and azimuth, degrees.
SkySettings sky_at(double elevation, double turbidity = 3, double azimuth = 215) {
    SkySettings sky;
    sky.sun = towards({azimuth, elevation}, 0);
    sky.turbidity = turbidity;
    return sky;
}

double lumens(const dvec3& watts) {
    return kLumensPerWatt * luminance(watts);
}

/// Irradiance of level ground and the integral of radiance over the upper half.
struct Energy {
    dvec3 ground{0.0}, all{0.0};
};
Energy energy_of(const auto& radiance, int heights, int turns) {
    Energy energy;
    for (int i = 0; i < heights; ++i)
        for (int j = 0; j < turns; ++j) {
            const double z = (i + .5) / heights, angle = 2 * M_PI * (j + .5) / turns;
            const double across = std::sqrt(1 - z * z);
            const dvec3 light = dvec3(radiance({across * std::cos(angle), across * std::sin(angle), z})) *
                                (2 * M_PI / (heights * turns));
            energy.ground += light * z;
            energy.all += light;
        }
    return energy;
}
Energy energy_of(const SkySettings& sky) {
    return energy_of([&](const dvec3& direction) { return sky_radiance(sky, direction); }, 200, 200);
}

bool good(const dvec3& light) {
    return std::isfinite(light.x + light.y + light.z) && std::min({light.x, light.y, light.z}) >= 0;
}

TEST(SkyModel, TheZenithHasTheLuminanceOfThePaper) {
    // Appendix A.2 by hand: T = 3, sun 60 degrees from the zenith: chi = .43924, 7.1649 tan(chi) + 1.7727.
    EXPECT_NEAR(lumens(sky_radiance(sky_at(30), {0, 0, 1})), 5140, 5);
    // T = 2, sun in the zenith: chi = 1.34390, 3.1196 tan(chi) + 1.9882.
    EXPECT_NEAR(lumens(sky_radiance(sky_at(90, 2), {0, 0, 1})), 15500, 100);
}

TEST(SkyModel, AClearSkyIsBlueAboveAndBrightAtTheHorizonAndBesideTheSun) {
    const SkySettings sky = sky_at(20);
    const dvec3 zenith = sky_radiance(sky, {0, 0, 1});
    EXPECT_GT(zenith.z, 2 * zenith.x);
    const dvec3 aside = glm::cross(sky.sun, dvec3(0, 0, 1));
    const dvec3 horizon = sky_radiance(sky, glm::normalize(aside + dvec3(0, 0, .02)));
    EXPECT_GT(luminance(horizon), 1.5 * luminance(zenith));
    EXPECT_LT(luminance(horizon), 3 * luminance(zenith)) << "that of CIE's clear sky (S 011, type 12)";
    EXPECT_GT(luminance(sky_radiance(sky, sky.sun)), 2 * luminance(horizon));
    EXPECT_LT(horizon.z / horizon.x, zenith.z / zenith.x) << "haze is whiter than air";
}

TEST(SkyModel, SunAndSkyHaveTheIlluminancesOfAClearDay) {
    // IES 1984, "Recommended Practice for the Calculation of Daylight Availability", clear sky: the sun gives
    // 127.5 exp(-.21 m) klx, m the optical air mass, and the sky .8 + 15.5 sqrt(sin h) klx.
    for (const double elevation : {20., 30., 45., 60., 75.}) {
        const double sine = std::sin(glm::radians(elevation));
        const double sun = 127500 * std::exp(-.21 / sine), sky = 800 + 15500 * std::sqrt(sine);
        EXPECT_NEAR(lumens(sun_irradiance(elevation, 2)) / sun, 1, .06) << elevation;
        const double model_sky = lumens(energy_of(sky_at(elevation)).ground);
        const double model = lumens(sun_irradiance(elevation, 3)) * sine + model_sky;
        EXPECT_NEAR(model / (sun * sine + sky), 1, .1) << elevation;
        // The model takes more of that for the sky.
        EXPECT_GT(model_sky, 1.5 * sky) << elevation;
        EXPECT_LT(model_sky, 2.2 * sky) << elevation;
    }
}

TEST(SkyModel, HazeDimsAndReddensTheSunAndBrightensTheSky) {
    for (const double elevation : {10., 30., 60.}) {
        dvec3 before = sun_irradiance(elevation, kLeastTurbidity);
        for (double turbidity = 2.5; turbidity <= kMostTurbidity; turbidity += .5) {
            const dvec3 sun = sun_irradiance(elevation, turbidity);
            EXPECT_LT(luminance(sun), luminance(before)) << elevation << ' ' << turbidity;
            EXPECT_LE(sun.z / sun.x, before.z / before.x);
            before = sun;
        }
    }
    EXPECT_GT(luminance(energy_of(sky_at(40, 6)).ground), 1.3 * luminance(energy_of(sky_at(40, 2)).ground));
    const dvec3 high = sun_irradiance(60, 3), low = sun_irradiance(4, 3);
    EXPECT_GT(low.x / low.z, 3 * high.x / high.z) << "a low sun is red";
}

TEST(SkyModel, ItsPictureHasTheEnergyOfTheModel) {
    for (const double elevation : {1., 25., 70.})
        for (const double turbidity : {2., 3., 8.}) {
            const SkySettings sky = sky_at(elevation, turbidity);
            const Environment picture = sky_environment(sky);
            const Energy model = energy_of(sky);
            const Energy texels = energy_of(
                [&](const dvec3& direction) { return picture.radiance(glm::vec3(direction)); }, 500, 1000);
            for (int channel = 0; channel < 3; ++channel) {
                EXPECT_NEAR(texels.ground[channel] / model.ground[channel], 1, .01) << elevation;
                EXPECT_NEAR(texels.all[channel] / model.all[channel], 1, .01) << elevation;
            }
            const dvec3 all = model.ground + sun_irradiance(elevation, turbidity) * sky.sun.z;
            const dvec3 ground = picture.radiance({.6f, 0, -.8f});
            EXPECT_NEAR(luminance(ground) / (.2 / M_PI * luminance(all)), 1, .01);
        }
}

TEST(SkyModel, ItsPictureIsTurnedToTheSunAndTheSameOnBothSidesOfIt) {
    for (const double azimuth : {0., 77., 180., 300.}) {
        const Environment picture = sky_environment(sky_at(35, 4, azimuth));
        float brightest = 0;
        double at = 0;
        for (double turn = .3; turn < 180; turn += 1) {  // not on a border of texels
            const auto radiance = [&](double angle) {
                return picture.radiance(glm::vec3(towards({azimuth + angle, 35}, 0)));
            };
            EXPECT_EQ(radiance(turn), radiance(-turn)) << azimuth << ' ' << turn;
            if (radiance(turn).y > brightest) brightest = radiance(turn).y, at = turn;
        }
        EXPECT_EQ(at, .3) << azimuth;
    }
}

TEST(SkyModel, NothingJumpsWhileTheSunSets) {
    const dvec3 directions[] = {{0, 0, 1}, {.6, 0, .8}, {-.995, 0, .0998}, {0, .995, .0998}};
    const dvec3 noon = sun_irradiance(90, 3);
    for (double elevation = 90; elevation > -25; elevation -= .05) {
        const SkySettings before = sky_at(elevation, 3, 90), after = sky_at(elevation - .05, 3, 90);
        for (const dvec3& direction : directions) {
            const dvec3 a = sky_radiance(before, direction), b = sky_radiance(after, direction);
            ASSERT_TRUE(good(a)) << elevation;
            EXPECT_NEAR(luminance(b) / luminance(a), 1, .07) << elevation;
        }
        const dvec3 a = sun_irradiance(elevation, 3), b = sun_irradiance(elevation - .05, 3);
        ASSERT_TRUE(good(a)) << elevation;
        EXPECT_LE(luminance(b), luminance(a)) << elevation;
        EXPECT_LT(luminance(a) - luminance(b), .01 * luminance(noon)) << elevation;
    }
    EXPECT_EQ(sun_irradiance(0, 3), dvec3(0));
    // Seidelmann 1992: 3.4 lx at the end of civil twilight, .008 lx at that of nautical twilight.
    EXPECT_NEAR(std::log10(lumens(energy_of(sky_at(-6)).ground) / 3.4), 0, .5);
    EXPECT_NEAR(std::log10(lumens(energy_of(sky_at(-12)).ground) / .008), 0, .5);
    EXPECT_LT(lumens(energy_of(sky_at(-60)).ground), .002) << "a night without moon";
    EXPECT_GT(lumens(energy_of(sky_at(-60)).ground), .0002);
}

TEST(SkyModel, EveryTexelIsFiniteWhereverTheSunStands) {
    for (const double elevation : {90., 89.999, 45., .1, 0., -.1, -5., -89., -90.})
        for (const double turbidity : {kLeastTurbidity, 5., kMostTurbidity}) {
            const Environment picture = sky_environment(sky_at(elevation, turbidity, 10));
            EXPECT_TRUE(std::isfinite(picture.rotation));
            EXPECT_TRUE(std::ranges::all_of(picture.texels, [](const glm::vec3& t) { return good(t); }))
                << elevation << ' ' << turbidity;
        }
}

Scene scene_of(const char* text) {
    auto scene = parse_scene(text, "sky.json");
    EXPECT_TRUE(scene) << scene.error().line();
    return scene ? *scene : Scene{};
}

TEST(SceneSky, FollowsTheSunOfTheScene) {
    Scene scene = scene_of(R"({"environment": {"sky": {"turbidity": 4, "ground": 0}}, "lights": [
        {"type": "point", "position": [0,0,0], "intensity": [1,1,1]},
        {"type": "directional", "on": false, "sun": {"latitude": 48.2, "longitude": 16.4,
         "time": "2026-06-21T12:00:00+02:00", "north": 30}}]})");
    ASSERT_EQ(scene.lights.size(), 2u);
    SceneLight& sun = scene.lights[1];
    const double elevation = solar_position(*sun.sun).elevation;
    EXPECT_EQ(sun.strength, sun_irradiance(elevation, 4));
    EXPECT_EQ(sun.angular_radius, kSunRadius);
    ASSERT_TRUE(scene.environment && scene.environment->sky);
    EXPECT_LT(glm::distance(scene.environment->sky->sun, towards(solar_position(*sun.sun), 30)), 1e-12);
    EXPECT_EQ(scene.environment->texels, sky_environment(*scene.environment->sky).texels);
    EXPECT_EQ(scene.environment->radiance({0, 0, -1}), glm::vec3(0)) << "black ground";
    const auto noon = scene.environment;
    update_daylight(scene);
    EXPECT_EQ(scene.environment, noon) << "nothing has changed, so engines keep their light";
    sun.sun->time.seconds += 7 * 3600;
    follow_sun(sun);
    update_daylight(scene);
    EXPECT_LT(luminance(sun.strength), .8 * luminance(sun_irradiance(elevation, 4)));
    EXPECT_LT(luminance(scene.environment->radiance({0, 0, 1})), .8f * luminance(noon->radiance({0, 0, 1})));
}

TEST(SceneSky, IsWrittenAsItsSettings) {
    for (
        const char* text :
        {R"({"environment": {"sky": {}}, "lights": [{"type": "directional", "direction": [1,2,-3]}]})",
         R"({"environment": {"on": false, "sky": {"turbidity": 5.5, "ground": 0.35, "direction": [1,2,-3]}}})",
         R"({"environment": {"sky": {"ground": 1}}, "lights": [{"type": "directional", "angular_radius": 0,
              "sun": {"latitude": 90, "longitude": 0, "time": "2026-12-21T12:00:00Z"}}]})",
         R"({"environment": {"sky": {}}, "lights": [
              {"type": "directional", "direction": [1,2,-3], "irradiance": [1,2,3]}]})"}) {
        const Scene scene = scene_of(text);
        const std::string written = write_scene(scene);
        EXPECT_LT(written.size(), 700u) << "settings, not texels";
        const Scene again = scene_of(written.c_str());
        EXPECT_EQ(again.lights, scene.lights) << written;
        EXPECT_EQ(again.environment_on, scene.environment_on);
        ASSERT_TRUE(again.environment && scene.environment);
        EXPECT_EQ(*again.environment, *scene.environment) << written;
        EXPECT_EQ(write_scene(again), written);
    }
}

TEST(SceneSky, MistakesAreReportedWithTheirPlace) {
    const std::tuple<const char*, const char*, const char*> mistakes[] = {
        {R"({"environment": {"sky": {"turbidity": 1, "direction": [0,0,-1]}}})", "/environment/sky/turbidity",
         "10"},
        {R"({"environment": {"sky": {"ground": 2, "direction": [0,0,-1]}}})", "/environment/sky/ground", "1"},
        {R"({"environment": {"sky": {}}})", "/environment/sky", "directional light"},
        {R"({"environment": {"sky": {"direction": [0,0,0]}}})", "/environment/sky/direction", "nowhere"},
        {R"({"environment": {"sky": {"direction": [0,0,-1]}}, "lights": [{"type": "directional", "direction": [0,0,-1]}]})",
         "/environment/sky/direction", "leave this out"},
        {R"({"environment": {"sky": {"direction": [0,0,-1], "haze": 3}}})", "/environment/sky/haze",
         "known key"},
        {R"({"environment": {"sky": {"direction": [0,0,-1]}, "radiance": [1,1,1]}})", "/environment/radiance",
         "known key"},
        {R"({"environment": {"sky": 3}})", "/environment/sky", "object"},
    };
    for (const auto& [text, place, reason] : mistakes) {
        const auto scene = parse_scene(text, "bad.json");
        ASSERT_FALSE(scene) << text;
        EXPECT_THAT(scene.error().line(), HasSubstr(place)) << text;
        EXPECT_THAT(scene.error().line(), HasSubstr(reason)) << text;
    }
}

}  // namespace
}  // namespace lucarne::gi
