// Bounced light of lights with a size.
#include <cmath>
#include <vector>

#include <glm/geometric.hpp>
#include <gtest/gtest.h>

#include "gi/bounce_options.h"
#include "gi/compare/metrics.h"
#include "gi/engines/reference/options.h"
#include "gi/engines/vpl/options.h"
#include "gi/lighting/light_options.h"
#include "tests/gi/engines/analytic_frame.h"
#include "tests/gi/engines/lit_scene.h"
#include "tests/gi/engines/surfel_scenes.h"
#include "tests/gi/engines/test_lights.h"
#include "tests/gi/on_device.h"

namespace lucarne::gi {
namespace {

using scenes::AnalyticScene;
using VplSoftLights = OnDevice;

/// A room of 2 m with a block in it, seen from within; without its ceiling if the sky shall light it.
AnalyticScene room(bool open) {
    AnalyticScene scene;
    const auto walls = scenes::closed_box(2, 40, glm::vec3(.6f));
    for (const Surfel& s : walls)
        if (!open || s.position.z < 1.999f) scene.surfels.push_back(s);
    for (Surfel s : scenes::closed_box(.5f, 12, glm::vec3(.6f))) {
        s.position += glm::vec3(1.2f, 1.1f, .02f);
        scene.surfels.push_back(s);
    }
    scene.camera = scenes::look(glm::vec3(.2f, .3f, 1.1f), glm::vec3(1.3f, 1.4f, .7f), .8f, 48);
    scene.settings.set(kVpls, 256);
    scene.settings.set(vpl::kInterleave, 1);
    scene.settings.set(vpl::kAtlas, 1024);
    scene.settings.set(kLightSamples, 16);
    scene.settings.set(reference::kSamples, 64);
    return scene;
}

double mean(Device& device, const char* engine, const AnalyticScene& scene, uint64_t frames) {
    double sum = 0;
    for (uint64_t i = 0; i < frames; ++i) {
        const auto one = scenes::render(device, engine, scene, i);
        EXPECT_TRUE(one) << one.error().line();
        for (const glm::vec4& p : one->radiance) EXPECT_TRUE(std::isfinite(p.x + p.y + p.z));
        sum += mean_luminance(one->radiance) / static_cast<double>(frames);
    }
    return sum;
}

void expect_the_references_energy(Device& device, AnalyticScene scene, const char* what) {
    for (const int only : {-1, 1}) {
        scene.settings.set(kOnlyBounce, only);
        scene.settings.set(kBounces, 3);
        const double truth = mean(device, "reference", scene, 1), found = mean(device, "vpl", scene, 4);
        std::printf("%s, only bounce %d: %+.2f %%\n", what, only, 100 * (found / truth - 1));
        EXPECT_NEAR(found / truth, 1, only < 0 ? .03 : .05) << what << ", only bounce " << only;
    }
}

TEST_F(VplSoftLights, RectangleLightsARoomAsInTheReference) {
    AnalyticScene scene = room(false);
    scene.lights = {scenes::rectangle_light({1, 1, 1.95f}, .3f * kX, .2f, -kZ, 10)};
    expect_the_references_energy(*device, scene, "rectangle");
}

TEST_F(VplSoftLights, DiscAndSpotTogetherLightARoomAsInTheReference) {
    AnalyticScene scene = room(false);
    scene.lights = {scenes::disc_light({.5f, 1, 1.2f}, .3f, glm::normalize(glm::vec3(1, .2f, .3f)), 6),
                    scenes::spot({1, .4f, 1.8f}, {.9f, 1.6f, 0}, .5f, .3f, 4)};
    expect_the_references_energy(*device, scene, "disc and spot");
}

TEST_F(VplSoftLights, SkyLightsAnOpenRoomAsInTheReference) {
    AnalyticScene scene = room(true);
    scene.environment = scenes::even_sky(1);
    scene.settings.set(kOnlyBounce, 0);
    const double truth = mean(*device, "reference", scene, 1), found = mean(*device, "vpl", scene, 8);
    std::printf("sky, direct light: %+.2f %%\n", 100 * (found / truth - 1));
    EXPECT_NEAR(found / truth, 1, .02);
}

// Under a sky of 1 every surface that reflects rho and emits 1 - rho has the radiance 1, so nothing can be
// distinguished.
TEST_F(VplSoftLights, OpenFurnaceUnderAnEvenSkyIsOneEverywhere) {
    AnalyticScene scene = room(true);
    for (Surfel& s : scene.surfels) s.albedo = glm::vec3(.5f);
    scene.environment = scenes::even_sky(1);
    scene.materials = {scenes::material(1, 0, 1, .5f)};
    scene.settings.set(kBounces, 5);  // the remaining bounces are below .5^6
    EXPECT_NEAR(mean(*device, "vpl", scene, 8), 1, .025);
}

TEST_F(VplSoftLights, LightsWithoutSizeOrLightInsideWallsAndBlackSkiesAreDefined) {
    AnalyticScene scene = room(false);
    scene.settings.set(kVpls, 64);
    scene.settings.set(vpl::kAtlas, 512);
    scene.environment = scenes::even_sky(0);
    const Light nothing[] = {
        scenes::rectangle_light({1, 1, 1}, kO, 0, -kZ, 1),
        scenes::rectangle_light({1, 1, 1}, .2f * kX, 0, -kZ, 1), scenes::disc_light({1, 1, 1}, 0, -kZ, 1),
        scenes::disc_light({1, 1, 1}, .2f, -kZ, 0), scenes::wide_sun({0, 0, -1}, .2f, 0)};
    for (const Light& light : nothing) {
        scene.lights = {light};
        EXPECT_EQ(mean(*device, "vpl", scene, 1), 0) << &light - nothing;
    }
    // A light in the plane of a wall, slightly in front of it and slightly behind it.
    for (const float x : {0.0f, 1e-4f, -1e-4f}) {
        scene.lights = {scenes::rectangle_light({x, 1, 1}, .2f * kY, .2f, kX, 1)};
        EXPECT_GE(mean(*device, "vpl", scene, 1), 0) << x;
    }
}

TEST_F(VplSoftLights, ManyTakeBoundedMemory) {
    AnalyticScene scene = room(false);
    scene.settings.set(kVpls, 64);
    scene.settings.set(vpl::kAtlas, 512);
    scene.settings.set(kLightResolution, 512);
    const uint64_t before = device->memory_used();
    device->set_memory_cap(before + (uint64_t{160} << 20));
    for (int i = 0; i < 64; ++i)
        scene.lights.push_back(
            scenes::disc_light({.1f + .028f * static_cast<float>(i), 1, 1.9f}, .02f, -kZ, 1));
    EXPECT_GT(mean(*device, "vpl", scene, 1), 0);
}

TEST_F(VplSoftLights, SamePicturesEveryRunAndOthersForOtherSeeds) {
    AnalyticScene scene = room(true);
    scene.environment = scenes::even_sky(1);
    scene.lights = {scenes::rectangle_light({1, 1, 1.9f}, .3f * kX, .2f, -kZ, 5)};
    scene.settings.set(kVpls, 64);
    scene.settings.set(vpl::kAtlas, 512);
    const auto first = scenes::render(*device, "vpl", scene, 3),
               again = scenes::render(*device, "vpl", scene, 3);
    scene.settings.set(kSeed, 2);
    const auto other = scenes::render(*device, "vpl", scene, 3);
    ASSERT_TRUE(first && again && other);
    EXPECT_EQ(first->radiance, again->radiance);
    EXPECT_NE(first->radiance, other->radiance);
}

TEST_F(VplSoftLights, AnotherSkyIsNotLitByTheLastOnesVpls) {
    const SurfelCloud cloud(room(true).surfels);
    auto engine = *make_engine("vpl");
    LitOptions options;
    options.settings.set(kVpls, 64);
    options.settings.set(vpl::kAtlas, 512);
    const CameraView camera = room(true).camera;
    for (const float radiance : {1.0f, 3.0f, 0.0f, 2.0f}) {
        options.environment = scenes::even_sky(radiance);
        EXPECT_EQ(light_up(*device, *engine, cloud, camera, options).radiance,
                  light_up(*device, **make_engine("vpl"), cloud, camera, options).radiance)
            << radiance;
    }
}

}  // namespace
}  // namespace lucarne::gi
