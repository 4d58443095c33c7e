#include "gi/gather/traced_lights.h"

#include <memory>
#include <string_view>
#include <utility>
#include <vector>

#include <gtest/gtest.h>

#include "gi/bounce_options.h"
#include "gi/compare/metrics.h"
#include "gi/engines/reference/options.h"
#include "gi/gather/gather_options.h"
#include "gi/lighting/light_options.h"
#include "gi/registry.h"
#include "tests/gi/engines/analytic_frame.h"
#include "tests/gi/engines/surfel_scenes.h"
#include "tests/gi/on_device.h"

namespace lucarne::gi {
namespace {

using scenes::AnalyticScene;

/// Direct light alone, of a floor and a wall behind a board in the air.
class TracedLightsTest : public OnDevice {
 protected:
    TracedLightsTest() {
        scenes::add_rectangle(scene_.surfels, kO, 2.0f * kX, 2.0f * kY, 60, glm::vec3(0.6f));
        scenes::add_rectangle(scene_.surfels, {0, 2, 0}, 2.0f * kX, 2.0f * kZ, 60, glm::vec3(0.6f));
        scenes::add_rectangle(scene_.surfels, {0.7f, 0.8f, 0.6f}, 0.6f * kX, 0.6f * kY, 18, glm::vec3(0.6f));
        scene_.camera = scenes::look({1, -1.5f, 1.6f}, {1, 1, 0.4f}, 0.6f, 64);
        scene_.settings.set(kOnlyBounce, 0);
        scene_.settings.set(kShadows, Shadows::rays);
        scene_.settings.set(reference::kSamples, 512);
    }
    Lit render(std::string_view engine) {
        auto rendered = scenes::render(*device, engine, scene_);
        EXPECT_TRUE(rendered) << rendered.error().line();
        return rendered ? std::move(*rendered) : Lit{};
    }
    double error(std::string_view engine) {
        const auto metrics = compare_images(render(engine).radiance, render("reference").radiance);
        EXPECT_TRUE(metrics);
        return metrics ? metrics->rel_mse : 1e9;
    }

    AnalyticScene scene_;
};

TEST_F(TracedLightsTest, PixelsSeeSharpLightsAsInTheReference) {
    scene_.lights = {scenes::spot({0.6f, 0.4f, 2}, {1, 1, 0}, 0.7f, 0.6f, 50),
                     scenes::point({1.8f, 0.3f, 1}, 10)};
    scene_.materials = {scenes::material(0.6f, 0.4f, 20, 0.1f)};
    for (const std::string_view engine : {"micro", "environment", "paths", "volume"})
        EXPECT_LT(error(engine), 1e-6) << engine;
}

// Two points of the lamp and eight directions of the sun stood for them in one frame.
TEST_F(TracedLightsTest, LightsWithASizeAreSoftInOneFrame) {
    scene_.lights = {scenes::rectangle_light({1, 1, 2}, 0.4f * kX, 0.4f, -kZ, 20),
                     scenes::wide_sun({0.5f, 0.3f, -1}, 0.1f, 10)};
    scene_.settings.set(kLightSamples, 16);
    for (const std::string_view engine : {"micro", "environment", "paths", "volume"})
        EXPECT_LT(error(engine), 0.002) << engine;
}

// As while a scan is being read: its points have no normals yet, and are no discs that rays could hit.
TEST_F(TracedLightsTest, SurfelsWithoutNormalsCastShadows) {
    scene_.surfels = scenes::closed_box(2, 60, glm::vec3(.6f));
    for (Surfel& surfel : scene_.surfels) surfel.normal = glm::vec3(0.0f);
    scene_.camera = scenes::look({.4f, .5f, .6f}, {1.5f, 1.4f, .8f}, 1.0f, 64);
    scene_.lights = {scenes::wide_sun({.2f, .3f, -1}, .01f, 10)};
    const std::string_view engines[] = {"volume", "micro", "environment", "reference"};
    for (const std::string_view engine : engines)
        EXPECT_LT(mean_luminance(render(engine).radiance), .01) << engine << ": the room is closed";
    for (Surfel& surfel : scene_.surfels)
        if (surfel.position.z > 1.9f) surfel.position.z += 100;
    for (const std::string_view engine : engines)
        EXPECT_GT(mean_luminance(render(engine).radiance), .2)
            << engine << ": without its ceiling the sun shines into it";
}

// And they reflect light: the sun shines through a hole in the ceiling onto the floor.
TEST_F(TracedLightsTest, SurfelsWithoutNormalsReflectLight) {
    scene_.surfels = scenes::closed_box(2, 60, glm::vec3(.6f));
    std::erase_if(scene_.surfels, [](const Surfel& surfel) {
        return surfel.position.z > 1.9f && glm::length(glm::vec2(surfel.position) - 1.0f) < .4f;
    });
    for (Surfel& surfel : scene_.surfels) surfel.normal = glm::vec3(0.0f);
    scene_.camera = scenes::look({.4f, .5f, .6f}, {1.5f, 1.4f, .8f}, 1.0f, 32);
    scene_.lights = {scenes::wide_sun({.2f, .3f, -1}, .01f, 10)};
    scene_.settings.set(kOnlyBounce, 1);
    const double truth = mean_luminance(render("reference").radiance);
    EXPECT_GT(truth, .01);
    EXPECT_NEAR(mean_luminance(render("environment").radiance) / truth, 1, .05);
    // Its buffers look from pixels whose normals are the viewer's directions: half of them into the wall.
    EXPECT_NEAR(mean_luminance(render("micro").radiance) / truth, 1, .15);
}

// What probing rays tell takes the place of rays: where a light is seen by all of them nothing changes, and
// where it is hidden nothing arrives.
TEST_F(TracedLightsTest, ProbesTellWhatPointsSeeOfALight) {
    const auto tracer = tracing::SurfelTracer::create(scene_.surfels);
    ASSERT_TRUE(tracer) << tracer.error().line();
    const std::vector<Light> lights{scenes::wide_sun({0, 0, -1}, 0.05f, 10)};
    const SkyDirections no_sky;
    const TracedLights few(**tracer, lights, no_sky, 2), many(**tracer, lights, no_sky, 16);
    EXPECT_EQ(few.probed(), 0u) << "two rays are cast at once";
    ASSERT_EQ(many.probed(), 1u);
    const auto sight = [&](const SurfacePoint& at) {
        uint8_t seen = TracedLights::kNoSight;
        many.probe(at, 1, {&seen, 1});
        return seen;
    };
    const auto on_floor = [](float x, float y) {
        return SurfacePoint{.position = {x, y, 0}, .normal = kZ, .viewer = kZ, .radius = 0.02f};
    };
    const SurfacePoint open = on_floor(0.3f, 0.4f), under = on_floor(1, 1.1f);
    SurfacePoint below = open;
    below.normal = below.viewer = -kZ;
    EXPECT_EQ(sight(open), TracedLights::kSeen);
    EXPECT_EQ(sight(under), TracedLights::kHidden);
    EXPECT_EQ(sight(below), TracedLights::kNoSight);
    const Reflectance grey{glm::vec3(0.6f), 0, 1};
    const auto reflected = [&](const SurfacePoint& at, std::vector<uint8_t> sights) {
        return many.reflected(at, grey, 1, sights);
    };
    EXPECT_GT(reflected(open, {}).x, 1);
    // All of the light at once is what sixteen rays find but for their noise.
    EXPECT_NEAR(reflected(open, {TracedLights::kSeen}).x / reflected(open, {}).x, 1, 1e-3);
    EXPECT_EQ(reflected(open, {TracedLights::kSeenInPart}), reflected(open, {}));
    EXPECT_EQ(reflected(open, {TracedLights::kHidden}), glm::vec3(0.0f));
    EXPECT_EQ(reflected(under, {}), glm::vec3(0.0f));
    EXPECT_EQ(reflected(under, {TracedLights::kSeen}), reflected(open, {TracedLights::kSeen}));
    SurfacePoint slanted = open;
    slanted.normal = glm::normalize(glm::vec3(1, 0, .02f));  // a part of the sun is below its plane
    EXPECT_EQ(reflected(slanted, {TracedLights::kSeen}), reflected(slanted, {}));
    EXPECT_GT(reflected(slanted, {}).x, 0);
}

TEST_F(TracedLightsTest, TheBrightPartOfASkyShinesInOneFrame) {
    auto sky = std::make_shared<Environment>();
    sky->width = 64;
    sky->height = 32;
    sky->texels.assign(64 * 32, glm::vec3(0.2f));
    for (const size_t y : {8, 9})
        for (const size_t x : {8, 9}) sky->texels[64 * y + x] = glm::vec3(2000);
    scene_.environment = sky;
    scene_.settings.set(kLightSamples, 16);
    scene_.settings.set(kGatherEvery, 1);
    for (const std::string_view engine : {"micro", "environment", "paths", "volume"})
        EXPECT_LT(error(engine), 0.01) << engine;
}

TEST_F(TracedLightsTest, PicturesInMotionHaveShadowsByMaps) {
    scene_.lights = {scenes::spot({0.6f, 0.4f, 2}, {1, 1, 0}, 0.7f, 0.6f, 50)};
    for (const std::string_view engine : {"micro", "environment", "paths", "volume"}) {
        const auto by_rays = render(engine).radiance;
        scene_.moving = true;
        const auto in_motion = render(engine).radiance;
        scene_.moving = false;
        scene_.settings.set(kShadows, Shadows::maps);
        EXPECT_EQ(render(engine).radiance, in_motion) << engine;
        scene_.settings.set(kShadows, Shadows::rays);
        EXPECT_NE(by_rays, in_motion) << engine;
    }
}

}  // namespace
}  // namespace lucarne::gi
