// Reuse between frames of a motion. tests/viewer/commands/fly_test.cpp tests that it makes them steadier.
#include <cmath>

#include "gi/bounce_options.h"
#include "gi/compare/metrics.h"
#include "gi/engines/vpl/options.h"
#include "gi/lighting/light_options.h"
#include "gi/registry.h"
#include "tests/gi/engines/lit_scene.h"
#include "tests/gi/engines/surfel_scenes.h"
#include "tests/gi/on_device.h"

namespace lucarne::gi {
namespace {

constexpr uint32_t kSide = 64;

class VplHistory : public OnDevice {
 protected:
    struct Shot {
        glm::vec3 eye{1, .4f, 1}, target{1.2f, 1.3f, .9f};
        float light_x = .5f;
        bool moving = true;
    };
    std::vector<glm::vec4> picture(Engine& engine, const Shot& shot) {
        const SurfelCloud cloud(scenes::closed_box(2, 60, glm::vec3(.5f)));
        LitOptions options;
        options.lights = {scenes::spot(glm::vec3(shot.light_x, 1, 1.8f), glm::vec3(1, 1, 0), .6f, .6f, 5)};
        options.settings.set(kOnlyBounce, 1);
        options.settings.set(kVpls, 64);
        options.settings.set(vpl::kInterleave, 4);
        options.settings.set(vpl::kAtlas, 512);
        options.moving = shot.moving;
        return light_up(*device, engine, cloud, look(shot.eye, shot.target, kSide, kSide), options).radiance;
    }
    std::vector<glm::vec4> alone(const Shot& shot) { return picture(**make_engine("vpl"), shot); }

    /// Returns the root mean squared difference over the mean.
    static double difference(const std::vector<glm::vec4>& a, const std::vector<glm::vec4>& b) {
        const auto metrics = compare_images(a, b);
        EXPECT_TRUE(metrics);
        return metrics->rmse / metrics->reference_mean_luminance;
    }
};

TEST_F(VplHistory, AStandingCameraSeesTheSameForever) {
    auto engine = *make_engine("vpl");
    const auto first = picture(*engine, {});
    for (int frame = 0; frame < 4; ++frame) EXPECT_LT(difference(picture(*engine, {}), first), 1e-4);
}

TEST_F(VplHistory, NothingIsLeftOfAnotherLight) {
    auto engine = *make_engine("vpl");
    picture(*engine, {});
    EXPECT_EQ(picture(*engine, {.light_x = .9f}), alone({.light_x = .9f}));
}

TEST_F(VplHistory, WhatWasNotSeenBeforeIsLitByItself) {
    auto engine = *make_engine("vpl");
    picture(*engine, {});
    const Shot behind{.target = {1, -1, 1}};
    EXPECT_EQ(picture(*engine, behind), alone(behind));
}

TEST_F(VplHistory, APictureThatIsNoneOfAMotionTakesNothingOver) {
    auto engine = *make_engine("vpl");
    Shot shot;
    for (int frame = 0; frame < 3; ++frame) {
        shot.eye.x += .02f;
        picture(*engine, shot);
    }
    shot.moving = false;
    EXPECT_EQ(picture(*engine, shot), alone(shot));
}

}  // namespace
}  // namespace lucarne::gi
