// Nested views of directional lights: which there are, and the light of a sun in a large scan by them.
#include "gi/lighting/nested_views.h"

#include <cmath>
#include <cstdio>

#include <glm/geometric.hpp>
#include <gtest/gtest.h>

#include "gi/bounce_options.h"
#include "gi/lighting/light_options.h"
#include "gi/registry.h"
#include "tests/gi/engines/lit_scene.h"
#include "tests/gi/lighting/town.h"
#include "tests/gi/on_device.h"

namespace lucarne::gi {
namespace {

using NestedViews = OnDevice;

Light sun() {
    return scenes::wide_sun({.3f, .5f, -.6f}, 0, 5);
}

TEST_F(NestedViews, AreAboutACameraInALargeScan) {
    const auto town = load_cloud(*device, scenes::town());
    ASSERT_TRUE(town);
    const auto views_from = [&](const glm::vec3& eye) {
        Light light = sun();
        set_nested_views(eye, scenes::town_bounds(), (*town)->cut, 64, light);
        return light;
    };
    const glm::vec3 eye(.1f, -.2f, .3f);
    const Light near = views_from(eye);
    ASSERT_GE(near.nested, 2u);
    EXPECT_FLOAT_EQ(near.position.w * std::pow(kNestedStep, static_cast<float>(near.nested - 1)),
                    glm::length(glm::vec3(8)));
    const glm::vec3 toward(sun().direction);
    EXPECT_LT(glm::length(glm::cross(glm::vec3(near.position) - eye, toward)), near.position.w / 4);
    EXPECT_EQ(views_from(eye + .05f * toward).position, near.position) << "along the light nothing changes";
    size_t steps = 0;
    glm::vec4 last = near.position;
    for (int i = 0; i < 100; ++i) {
        const glm::vec4 now =
            views_from(eye + .002f * near.position.w * static_cast<float>(i) * glm::vec3(1, -1, 0)).position;
        steps += now != last;
        last = now;
    }
    EXPECT_GT(steps, 0u);
    EXPECT_LT(steps, 10u);
    EXPECT_EQ(views_from(glm::vec3(500)).nested, 1u) << "the scan is far away";

    const auto room = load_cloud(*device, SurfelCloud(scenes::closed_box(1, 40, glm::vec3(.5f))));
    ASSERT_TRUE(room);
    Light light = sun();
    set_nested_views(glm::vec3(.5f), {glm::vec3(0), glm::vec3(1)}, (*room)->cut, 64, light);
    EXPECT_EQ(light.nested, 1u) << "one view is fine enough";
}

TEST_F(NestedViews, AreAtLeastOneInAnEmptyScan) {
    const auto empty = load_cloud(*device, SurfelCloud({}));
    ASSERT_TRUE(empty);
    Light light = sun();
    set_nested_views(glm::vec3(0), {glm::vec3(0), glm::vec3(0)}, (*empty)->cut, 64, light);
    EXPECT_EQ(light.nested, 1u);
    EXPECT_EQ(light_faces(light), 1u);
}

TEST_F(NestedViews, ShowAPointByTheFinestThatReachesIt) {
    Light light = sun();
    light.nested = 3;
    light.position = glm::vec4(1, 2, 3, .5f);
    const glm::vec3 along(light.direction), across = glm::normalize(glm::cross(along, glm::vec3(0, 0, 1)));
    for (const float depth : {-50.0f, 0.0f, 50.0f}) {
        const auto face = [&](float distance) {
            return light_face(light, depth * along + distance * across);
        };
        EXPECT_EQ(face(0), 0u);
        EXPECT_EQ(face(.49f), 0u);
        EXPECT_EQ(face(.51f), 1u);
        EXPECT_EQ(face(-1.99f), 1u);
        EXPECT_EQ(face(2.01f), 2u);
        EXPECT_EQ(face(1e6f), 2u) << "the last shows everything";
    }
}

/// How a picture of the town by an engine compares with that of the reference.
struct Agreement {
    double mean_error;   ///< relative
    double share_apart;  ///< of the pixels, which differ by more than a tenth of the mean
};

Agreement compare(Device& device, const char* engine, uint32_t bounce, uint32_t resolution = 64) {
    const SurfelCloud cloud = scenes::town();
    LitOptions options{.lights = {sun()}};
    options.settings.set(kOnlyBounce, bounce);
    options.settings.set(kLightResolution, resolution);
    options.settings.set(kVpls, 1024);
    const CameraView camera = scenes::seen_town(48);
    const auto picture = [&](const char* name) {
        const auto made = *make_engine(name);
        return light_up(device, *made, cloud, camera, options).radiance;
    };
    const auto found = picture(engine), truth = picture("reference");
    double sum = 0, true_sum = 0, apart = 0;
    for (size_t i = 0; i < truth.size(); ++i) sum += found[i].y, true_sum += truth[i].y;
    const auto pixels = static_cast<double>(truth.size());
    for (size_t i = 0; i < truth.size(); ++i)
        apart += std::abs(found[i].y - truth[i].y) > .1 * true_sum / pixels;
    const Agreement result{sum / true_sum - 1, apart / pixels};
    std::printf("%s, bounce %u: mean %+.2f %%, %.2f %% of the pixels differ\n", engine, bounce,
                100 * result.mean_error, 100 * result.share_apart);
    return result;
}

TEST_F(NestedViews, GiveTheDirectLightOfTheReference) {
    const Agreement direct = compare(*device, "direct", 0, 128);
    EXPECT_LT(std::abs(direct.mean_error), .02);
    EXPECT_LT(direct.share_apart, .05) << "only edges of shadows";
}

TEST_F(NestedViews, GiveTheBouncedLightOfTheReference) {
    const double whole = compare(*device, "vpl", 1, 1024).mean_error;  // one view, which is fine enough
    for (const bool natively : {true, false}) {
        device->use_native_passes(natively);
        EXPECT_LT(std::abs(compare(*device, "vpl", 1, 128).mean_error - whole), .04) << natively;
    }
    EXPECT_LT(std::abs(compare(*device, "micro", 1).mean_error), .05);
}

}  // namespace
}  // namespace lucarne::gi
