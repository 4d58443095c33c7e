// Direct light of lights with a size, from the samples of one frame and of many frames, compared with the
// path tracer and with formulas.
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
#include "tests/gi/engines/surfel_scenes.h"
#include "tests/gi/engines/test_lights.h"
#include "tests/gi/on_device.h"

namespace lucarne::gi {
namespace {

using scenes::AnalyticScene;
using SoftLights = OnDevice;

/// A floor with a block that hovers over it, seen from above.
AnalyticScene floor_and_block() {
    AnalyticScene scene;
    scenes::add_rectangle(scene.surfels, kO, 2.0f * kX, 2.0f * kY, 80, glm::vec3(.5f));
    for (Surfel s : scenes::closed_box(.4f, 16, glm::vec3(.5f))) {
        s.position += glm::vec3(.8f, .8f, .25f);
        scene.surfels.push_back(s);
    }
    scene.camera = scenes::look(glm::vec3(1.1f, .2f, 3), glm::vec3(1, 1, 0), .4f, 64);
    scene.settings.set(kOnlyBounce, 0);
    scene.settings.set(kLightSamples, 16);
    scene.settings.set(reference::kSamples, 256);
    return scene;
}

std::vector<glm::vec4> average(Device& device, const AnalyticScene& scene, int frames) {
    std::vector<glm::vec4> mean;
    for (int i = 0; i < frames; ++i) {
        const auto one = scenes::render(device, "direct", scene, static_cast<uint64_t>(i));
        EXPECT_TRUE(one) << one.error().line();
        mean.resize(one->radiance.size(), glm::vec4(0));
        for (size_t p = 0; p < mean.size(); ++p) mean[p] += one->radiance[p] / static_cast<float>(frames);
    }
    return mean;
}

void expect_like_the_reference(Device& device, const AnalyticScene& scene, const char* what) {
    const auto truth = scenes::render(device, "reference", scene);
    ASSERT_TRUE(truth) << truth.error().line();
    double before = 0;
    for (const int frames : {1, 16}) {
        const auto metrics = compare_images(average(device, scene, frames), truth->radiance);
        ASSERT_TRUE(metrics);
        std::printf("%s, %d frames: mean %+.2f %%, relMSE %.5f\n", what, frames,
                    100 * metrics->luminance_error, metrics->rel_mse_trimmed);
        EXPECT_LT(std::abs(metrics->luminance_error), frames == 1 ? .03 : .01) << what;
        if (frames == 1)
            before = metrics->rel_mse_trimmed;
        else
            EXPECT_LT(metrics->rel_mse_trimmed, std::max(.2 * before, .004)) << what << ", before " << before;
    }
}

TEST_F(SoftLights, RectangleCastsTheReferencesPenumbraWhenAveraged) {
    AnalyticScene scene = floor_and_block();
    scene.lights = {scenes::rectangle_light({1.2f, 1.1f, 1.6f}, .3f * kX, .2f, -kZ, 3)};
    expect_like_the_reference(*device, scene, "rectangle");
}

TEST_F(SoftLights, DiscCastsTheReferencesPenumbraWhenAveraged) {
    AnalyticScene scene = floor_and_block();
    scene.lights = {scenes::disc_light({1.7f, .8f, 1.4f}, .25f, glm::normalize(glm::vec3(-.5f, .1f, -1)), 3)};
    expect_like_the_reference(*device, scene, "disc");
}

// Two points stand in for a lamp in one frame of `interactive`. Random shifts of their sequence put both at
// one edge of the lamp with some seeds.
TEST_F(SoftLights, FirstFramesOfALampHaveEvenSamples) {
    AnalyticScene scene = floor_and_block();
    scene.settings.set(kLightSamples, 8);
    for (const Light& lamp : {scenes::rectangle_light({1.2f, 1.1f, 1.6f}, .3f * kX, .2f, -kZ, 3),
                              scenes::disc_light({1.2f, 1.1f, 1.6f}, .3f, -kZ, 3)}) {
        scene.lights = {lamp};
        const auto truth = scenes::render(*device, "reference", scene);
        ASSERT_TRUE(truth) << truth.error().line();
        for (const int frames : {1, 2, 4}) {
            constexpr int kSeeds = 8;
            double error = 0;
            for (uint64_t seed = 1; seed <= kSeeds; ++seed) {
                scene.settings.set(kSeed, seed);
                const auto metrics = compare_images(average(*device, scene, frames), truth->radiance);
                ASSERT_TRUE(metrics);
                error += metrics->rel_mse_trimmed / kSeeds;
            }
            std::printf("lamp %u, %d frames: relMSE %.5f\n", lamp.kind, frames, error);
            // With random shifts: .043, .013, .009 for the rectangle and .075, .017, .012 for the disc.
            EXPECT_LT(error, frames == 1 ? .033 : frames == 2 ? .015 : .011);
        }
    }
}

TEST_F(SoftLights, SunCastsTheReferencesPenumbraWhenAveraged) {
    AnalyticScene scene = floor_and_block();
    scene.lights = {scenes::wide_sun({.4f, .2f, -1}, .15f, 3)};
    expect_like_the_reference(*device, scene, "sun");
}

TEST_F(SoftLights, SkyShadesAsTheReferencesDoesWhenAveraged) {
    AnalyticScene scene = floor_and_block();
    auto sky = std::make_shared<Environment>();
    *sky = {64, 32, std::vector<glm::vec3>(64 * 32), .7f};
    for (size_t i = 0; i < sky->texels.size(); ++i)
        sky->texels[i] = glm::vec3(static_cast<float>(i % 61 + i / 200));
    scene.environment = sky;
    expect_like_the_reference(*device, scene, "sky");
}

/// Returns the mean irradiance of a unit square under a light of about unit radiance, over pi: a form
/// factor.
double form_factor(Device& device, const Light& light) {
    AnalyticScene scene;
    scenes::add_rectangle(scene.surfels, kO, kX, kY, 60, glm::vec3(.5f));
    // Seen from far away, so that every part of the receiver counts alike.
    scene.camera = scenes::look(glm::vec3(.5f, .5f, 40), glm::vec3(.5f, .5f, 0), .02f, 96);
    scene.settings.set(kOnlyBounce, 0);
    scene.settings.set(kLightSamples, 64);
    scene.lights = {light};
    const auto picture = average(device, scene, 4);
    const auto texels = scenes::render(device, "direct", scene)->texels;
    double sum = 0, pixels = 0;
    for (size_t i = 0; i < texels.size(); ++i) {
        const glm::vec3 at = scenes::position_of(scene.camera, texels, i);
        if (!(texels[i].depth > 0) || std::abs(at.x - .5f) > .5f || std::abs(at.y - .5f) > .5f) continue;
        sum += picture[i].y / .5;
        ++pixels;
    }
    return sum / pixels;
}

// Howell's catalogue, C-11 and C-14.
TEST_F(SoftLights, RectanglesSendTheirFormFactorsToASquare) {
    const auto over = [](float height) {
        return scenes::rectangle_light({.5f, .5f, height}, .5f * kX, .5f, -kZ, 1);
    };
    EXPECT_NEAR(form_factor(*device, over(1)) / .199825, 1, .02);
    EXPECT_NEAR(form_factor(*device, over(.5f)) / .415253, 1, .02);
    const Light wall = scenes::rectangle_light({0, .5f, .5f}, .5f * kY, .5f, kX, 1);
    // Much of the light comes from the foot of the wall, less than a surfel's radius high, where everything
    // is in shadow.
    EXPECT_NEAR(form_factor(*device, wall) / .200044, 1, .1);
}

TEST_F(SoftLights, DiscSendsItsFormFactorToAPointUnderIt) {
    AnalyticScene scene;
    scenes::add_rectangle(scene.surfels, kO, kX, kY, 100, glm::vec3(.5f));
    scene.camera = scenes::look(glm::vec3(.5f, .5f, 3), glm::vec3(.5f, .5f, 0), .005f, 16);
    scene.settings.set(kOnlyBounce, 0);
    scene.settings.set(kLightSamples, 64);
    for (const float height : {.3f, 1.0f}) {
        scene.lights = {scenes::disc_light({.5f, .5f, height}, .4f, -kZ, 2)};
        const double truth = 2 * .5 * .4 * .4 / (.4 * .4 + height * height);
        EXPECT_NEAR(mean_luminance(average(*device, scene, 8)) / truth, 1, .025) << height;
    }
}

TEST_F(SoftLights, SealedRoomStaysBlackUnderAnyOfThemOutside) {
    AnalyticScene scene;
    scene.surfels = scenes::closed_box(1, 40, glm::vec3(.9f));
    scene.camera = scenes::look(glm::vec3(.5f), glm::vec3(.9f, .8f, .4f), .8f, 64);
    scene.settings.set(kVpls, 64);
    scene.settings.set(vpl::kAtlas, 512);
    scene.settings.set(kLightSamples, 24);
    scene.lights = {scenes::rectangle_light({.5f, .5f, 1.2f}, .4f * kX, .4f, -kZ, 1000),
                    scenes::disc_light({-.1f, .5f, .4f}, .3f, kX, 1000),
                    scenes::wide_sun({-.3f, .2f, -1}, .3f, 1000)};
    scene.environment = scenes::even_sky(1000);
    const auto lights = scene.lights;
    const auto sky = scene.environment;
    for (size_t which = 0; which <= lights.size(); ++which) {
        scene.lights.clear();
        scene.environment = which == lights.size() ? sky : nullptr;
        if (which < lights.size()) scene.lights = {lights[which]};
        for (const char* engine : {"direct", "vpl"}) {
            const auto picture = scenes::render(*device, engine, scene);
            ASSERT_TRUE(picture) << picture.error().line();
            float brightest = 0;
            size_t lit = 0;
            for (const glm::vec4& p : picture->radiance) {
                brightest = std::max(brightest, p.y);
                lit += p.y > 0;
            }
            EXPECT_EQ(brightest, 0) << engine << ", light " << which << ", " << lit << " pixels";
        }
    }
}

}  // namespace
}  // namespace lucarne::gi
