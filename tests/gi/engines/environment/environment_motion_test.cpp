// While the camera moves, frames show the light that a finished frame has left.
#include <atomic>
#include <cmath>

#include <gtest/gtest.h>

#include "gi/bounce_options.h"
#include "gi/engines/environment/kept_caches.h"
#include "gi/gather/gather_options.h"
#include "gi/registry.h"
#include "gi/shared/luminance.h"
#include "tests/gi/engines/lit_scene.h"
#include "tests/gi/engines/surfel_scenes.h"
#include "tests/gi/on_device.h"

namespace lucarne::gi {
namespace {

class EnvironmentMotion : public OnDevice {
 protected:
    EnvironmentMotion() : cloud_(scenes::closed_box(2, 60, glm::vec3(.6f))) {
        options_.lights = {scenes::spot(glm::vec3(.6f, 1, 1.8f), glm::vec3(1, 1, 0), .6f, .6f, 5)};
        options_.settings.set(kBounces, 2);
        options_.settings.set(kShadows, Shadows::maps);  // as in motion: it is other light that is kept
        options_.bounds = {glm::vec3(0), glm::vec3(2)};
    }
    std::vector<glm::vec4> picture(Engine& engine, const glm::vec3& target) {
        return light_up(*device, engine, cloud_, look({.3f, .4f, .5f}, target, 64, 48), options_).radiance;
    }
    std::vector<glm::vec4> in_motion(Engine& engine, const glm::vec3& target) {
        options_.moving = true;
        options_.light_budget = StepBudget::paused();
        auto radiance = picture(engine, target);
        options_.moving = false;
        options_.light_budget = {};
        return radiance;
    }
    double figure(const Engine& engine, std::string_view name) {
        for (const auto& [key, value] : engine.stats())
            if (key == name) return value;
        ADD_FAILURE() << name;
        return 0;
    }
    /// Mean of the differences' sizes, in shares of the mean luminance of `right`.
    static double difference(const std::vector<glm::vec4>& right, const std::vector<glm::vec4>& other) {
        double sum = 0, all = 0;
        for (size_t i = 0; i < right.size(); ++i) {
            sum += std::abs(luminance(glm::dvec3(right[i])) - luminance(glm::dvec3(other[i])));
            all += luminance(glm::dvec3(right[i]));
        }
        return sum / all;
    }

    const glm::vec3 ahead_{1.2f, 1.3f, .9f}, aside_{1.5f, .9f, .8f}, behind_{-.3f, -.2f, .3f};
    const SurfelCloud cloud_;
    LitOptions options_;
};

TEST_F(EnvironmentMotion, AFrameAfterAWholeOneShowsItsLightWithoutGatheringAgain) {
    auto engine = *make_engine("environment"), other = *make_engine("environment");
    EXPECT_FALSE(engine->keeps_light(options_.settings, 0)) << "there is no light yet";
    picture(*engine, ahead_);
    EXPECT_TRUE(engine->keeps_light(options_.settings, 0));
    const auto moved = in_motion(*engine, aside_), right = picture(*other, aside_);
    EXPECT_EQ(figure(*engine, "primary_points"), 0);
    EXPECT_LT(difference(right, moved), 0.05);
}

TEST_F(EnvironmentMotion, WhatNoEarlierFrameHasSeenIsGatheredAtSomePixels) {
    auto engine = *make_engine("environment"), other = *make_engine("environment");
    picture(*engine, ahead_);
    const auto moved = in_motion(*engine, behind_), right = picture(*other, behind_);
    EXPECT_GT(figure(*engine, "lonely_pixels"), 20);
    EXPECT_LT(figure(*engine, "lonely_pixels"), 64 * 48 / 8);
    EXPECT_LT(difference(right, moved), 0.08);
    in_motion(*engine, behind_);
    EXPECT_LT(figure(*engine, "lonely_pixels"), 20) << "the caches of the motion are kept as well";
}

TEST_F(EnvironmentMotion, LightOfOtherContentOrOtherBouncesIsNotKept) {
    auto engine = *make_engine("environment");
    picture(*engine, ahead_);
    EXPECT_FALSE(engine->keeps_light(options_.settings, 1));
    EngineSettings more = options_.settings;
    more.set(kBounces, 3);
    EXPECT_FALSE(engine->keeps_light(more, 0));
    options_.settings.set(kBounces, 3);
    in_motion(*engine, aside_);
    EXPECT_GT(figure(*engine, "primary_points"), 0) << "so the frame is a whole one";
}

// Lobes that are too narrow for caches look wider, until the camera rests.
TEST_F(EnvironmentMotion, GlossySurfacesReflectTheLightOfCaches) {
    for (const float exponent : {8.0f, 20.0f, 200.0f}) {
        options_.materials = {scenes::material(.4f, .5f, exponent)};
        auto engine = *make_engine("environment"), other = *make_engine("environment");
        picture(*engine, ahead_);
        EXPECT_TRUE(engine->keeps_light(options_.settings, 0));
        const auto moved = in_motion(*engine, aside_), right = picture(*other, aside_);
        EXPECT_EQ(figure(*engine, "primary_points"), 0);
        EXPECT_LT(difference(right, moved), exponent > 28 ? .2 : .1) << exponent;
    }
}

TEST_F(EnvironmentMotion, AFrameThatWasGivenUpLeavesTheLightOfTheOneBefore) {
    auto engine = *make_engine("environment"), other = *make_engine("environment");
    picture(*engine, ahead_);
    std::atomic<bool> stop = true;
    options_.stop = &stop;
    options_.settings.set(kSeed, 7);
    light_up(*device, *engine, cloud_, look({.3f, .4f, .5f}, aside_, 64, 48), options_);
    options_.stop = nullptr;
    EXPECT_TRUE(engine->keeps_light(options_.settings, 0));
    EXPECT_LT(difference(picture(*other, aside_), in_motion(*engine, aside_)), 0.1);
}

TEST_F(EnvironmentMotion, SecondaryPointsOfEarlierViewsDoNotGatherAgain) {
    const auto loaded = load_cloud(*device, cloud_);
    ASSERT_TRUE(loaded) << loaded.error().line();
    const auto draw = [&](Engine& engine, const glm::vec3& target) {
        auto lit = draw_frame(*device, engine, (*loaded)->pool, (*loaded)->cut,
                              look({.3f, .4f, .5f}, target, 64, 48), *options_.bounds, options_);
        EXPECT_TRUE(lit) << lit.error().line();
        return lit ? lit->radiance : std::vector<glm::vec4>();
    };
    auto engine = *make_engine("environment"), other = *make_engine("environment");
    draw(*engine, ahead_);
    const auto moved = draw(*engine, aside_), right = draw(*other, aside_);
    EXPECT_GT(figure(*other, "after_down"), 20);
    EXPECT_LT(figure(*engine, "after_down"), .5 * figure(*other, "after_down"));
    EXPECT_LT(difference(right, moved), 1e-4);
    // Under other light all of them gather.
    const auto expect_new = [&](const glm::vec3& target, const char* what) {
        const auto again = draw(*engine, target);
        auto fresh = *make_engine("environment");
        EXPECT_EQ(again, draw(*fresh, target)) << what;
    };
    options_.settings.set(kSeed, 7);
    expect_new(aside_, "seed");
    options_.materials = {scenes::material(.4f)};
    expect_new(ahead_, "material");
    options_.lights = {scenes::spot(glm::vec3(.8f, 1, 1.8f), glm::vec3(.5f, .4f, 0), .6f, .6f, 9)};
    expect_new(aside_, "lamp");
    auto sky = std::make_shared<Environment>();
    sky->width = sky->height = 1;
    sky->texels = {glm::vec3(2)};
    options_.environment = sky;
    expect_new(ahead_, "sky");
    options_.environment = nullptr;
    expect_new(aside_, "no sky");
}

// Places, micro-buffers and reflectances stay while only lights change.
TEST_F(EnvironmentMotion, UnderOtherLightItShowsWhatANewEngineShows) {
    auto sky = std::make_shared<Environment>();
    sky->width = sky->height = 1;
    sky->texels = {glm::vec3(2)};
    options_.environment = sky;
    options_.settings.set(kBounces, 3);
    std::vector<Surfel> open = scenes::closed_box(2, 60, glm::vec3(.6f));
    std::erase_if(open, [](const Surfel& s) {
        return s.position.z > 1.9f && glm::length(glm::vec2(s.position) - 1.0f) < .3f;
    });
    const auto loaded = load_cloud(*device, SurfelCloud(open));
    ASSERT_TRUE(loaded) << loaded.error().line();
    const auto draw = [&](Engine& engine) {
        auto lit = draw_frame(*device, engine, (*loaded)->pool, (*loaded)->cut,
                              look({.3f, .4f, .5f}, ahead_, 64, 48), *options_.bounds, options_);
        EXPECT_TRUE(lit) << lit.error().line();
        return lit ? lit->radiance : std::vector<glm::vec4>();
    };
    auto engine = *make_engine("environment"), lamp = *make_engine("environment"),
         paint = *make_engine("environment");
    const auto first = draw(*engine);
    options_.lights = {scenes::spot(glm::vec3(.8f, 1, 1.8f), glm::vec3(.5f, .4f, 0), .6f, .6f, 9)};
    const auto second = draw(*engine);
    EXPECT_NE(second, first);
    EXPECT_EQ(second, draw(*lamp));
    options_.materials = {scenes::material(.4f)};
    const auto third = draw(*engine);
    EXPECT_NE(third, second);
    EXPECT_EQ(third, draw(*paint));
}

TEST(KeptCaches, StayOutsideThePictureOfTheNextWholeFrameAndNeverExceedTheirMost) {
    using environment::Cache;
    using environment::KeptCaches;
    const EngineSettings settings = test_settings();
    const CameraView camera = look({0, 0, 5}, {0, 0, 0}, 64, 64);
    KeptCaches kept;
    const std::vector<Cache> seen(10, Cache{}), beside(7, Cache{.position = {50, 0, 0}});
    kept.take(camera, settings, 1, seen);
    kept.add(beside);
    EXPECT_EQ(kept.all().size(), 17u);
    kept.take(camera, settings, 1, seen);
    EXPECT_EQ(kept.all().size(), 17u) << "what lies in the picture is replaced";
    kept.take(camera, settings, 2, seen);
    EXPECT_EQ(kept.all().size(), 10u) << "other content";
    kept.add(std::vector<Cache>(KeptCaches::kMostKept, beside[0]));
    EXPECT_EQ(kept.all().size(), KeptCaches::kMostKept);
    kept.take(camera, settings, 2, seen);
    EXPECT_EQ(kept.all().size(), KeptCaches::kMostKept);
    kept.take(camera, settings, 2, std::vector<Cache>(KeptCaches::kMostKept + 5, seen[0]));
    EXPECT_EQ(kept.all().size(), KeptCaches::kMostKept);
}

}  // namespace
}  // namespace lucarne::gi
