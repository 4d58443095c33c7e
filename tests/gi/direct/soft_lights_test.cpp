// Direct light from what has a size, by its samples of a frame and of many frames, against the path tracer
// and against formulas.
#include <cmath>
#include <vector>

#include <glm/geometric.hpp>
#include <gtest/gtest.h>

#include "gi/compare/metrics.h"
#include "tests/gi/analytic_frame.h"
#include "tests/gi/on_device.h"
#include "tests/gi/surfel_scenes.h"

namespace lucarne::gi {
namespace {

using scenes::AnalyticScene;
using SoftLights = OnDevice;

const glm::vec3 kX(1, 0, 0), kY(0, 1, 0), kZ(0, 0, 1), kO(0.0f);

Light rectangle(const glm::vec3& middle, const glm::vec3& half_edge, float other_half,
                const glm::vec3& normal, float radiance) {
    Light light{};
    light.kind = kRectangleLight;
    light.position = glm::vec4(middle, 0);
    light.direction = glm::vec4(normal, 0);
    light.extent = glm::vec4(half_edge, other_half);
    light.strength = glm::vec4(glm::vec3(radiance), 0);
    return light;
}
Light disc(const glm::vec3& middle, float radius, const glm::vec3& normal, float radiance) {
    Light light = rectangle(middle, glm::vec3(0), radius, normal, radiance);
    light.kind = kDiscLight;
    return light;
}
Light sun(const glm::vec3& direction, float angular_radius, float irradiance) {
    Light light{};
    light.kind = kDirectionalLight;
    light.direction = glm::vec4(glm::normalize(direction), angular_radius);
    light.strength = glm::vec4(glm::vec3(irradiance), 0);
    return light;
}

/// A floor with a block that hovers over it, seen from above.
AnalyticScene floor_and_block() {
    AnalyticScene scene;
    scenes::add_rectangle(scene.surfels, kO, 2.0f * kX, 2.0f * kY, 80, glm::vec3(.5f));
    for (Surfel s : scenes::closed_box(.4f, 16, glm::vec3(.5f))) {
        s.position += glm::vec3(.8f, .8f, .25f);
        scene.surfels.push_back(s);
    }
    scene.camera = scenes::look(glm::vec3(1.1f, .2f, 3), glm::vec3(1, 1, 0), .4f, 64);
    scene.settings.only_bounce = 0;
    scene.settings.light_samples = 16;
    scene.settings.samples = 256;
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
    scene.lights = {rectangle({1.2f, 1.1f, 1.6f}, .3f * kX, .2f, -kZ, 3)};
    expect_like_the_reference(*device, scene, "rectangle");
}

TEST_F(SoftLights, DiscCastsTheReferencesPenumbraWhenAveraged) {
    AnalyticScene scene = floor_and_block();
    scene.lights = {disc({1.7f, .8f, 1.4f}, .25f, glm::normalize(glm::vec3(-.5f, .1f, -1)), 3)};
    expect_like_the_reference(*device, scene, "disc");
}

TEST_F(SoftLights, SunCastsTheReferencesPenumbraWhenAveraged) {
    AnalyticScene scene = floor_and_block();
    scene.lights = {sun({.4f, .2f, -1}, .15f, 3)};
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

}  // namespace
}  // namespace lucarne::gi
