// Direct light of every kind of light that a shadow map can represent, compared with the path tracer.
#include <algorithm>
#include <cmath>
#include <vector>

#include <glm/geometric.hpp>
#include <gtest/gtest.h>

#include "gi/bounce_options.h"
#include "gi/engines/reference/options.h"
#include "gi/lighting/light_options.h"
#include "tests/gi/engines/analytic_frame.h"
#include "tests/gi/engines/surfel_scenes.h"
#include "tests/gi/on_device.h"

namespace lucarne::gi {
namespace {

using scenes::AnalyticScene;
using DirectLights = OnDevice;

Light point_light(const glm::vec3& position, float intensity) {
    Light light{};
    light.kind = kPointLight;
    light.position = glm::vec4(position, 0);
    light.strength = glm::vec4(glm::vec3(intensity), 0);
    return light;
}
Light sharp_sun(const glm::vec3& direction, float irradiance) {
    Light light{};
    light.kind = kDirectionalLight;
    light.direction = glm::vec4(glm::normalize(direction), 0);
    light.strength = glm::vec4(glm::vec3(irradiance), 0);
    return light;
}

/// A floor and two walls with a block in front of them that casts shadows on all three.
AnalyticScene corner_with_block() {
    const glm::vec3 x(1, 0, 0), y(0, 1, 0), z(0, 0, 1), o(0.0f), grey(.5f);
    AnalyticScene scene;
    scenes::add_rectangle(scene.surfels, o, 2.0f * x, 2.0f * y, 80, grey);
    scenes::add_rectangle(scene.surfels, o, 2.0f * y, 2.0f * z, 80, grey);
    scenes::add_rectangle(scene.surfels, o, 2.0f * z, 2.0f * x, 80, grey);
    const glm::vec3 at(.6f, .7f, .3f), size(.4f);
    auto block = scenes::closed_box(size.x, 16, grey);
    for (Surfel& s : block) {
        s.position += at;
        scene.surfels.push_back(s);
    }
    scene.camera = scenes::look(glm::vec3(3.2f, 3.0f, 2.4f), glm::vec3(.7f, .7f, .5f), .45f, 96);
    scene.settings.set(kOnlyBounce, 0);
    scene.settings.set(kLightResolution, 1024);
    scene.settings.set(reference::kSamples, 1);
    return scene;
}

struct Agreement {
    double mean_error;   ///< relative error of the mean luminance
    double share_apart;  ///< of the pixels that differ by more than a tenth of the mean
    double lit;          ///< share of the pixels that the reference lights
};

Agreement compare(Device& device, const AnalyticScene& scene) {
    const auto direct = scenes::render(device, "direct", scene),
               truth = scenes::render(device, "reference", scene);
    EXPECT_TRUE(direct) << direct.error().line();
    EXPECT_TRUE(truth) << truth.error().line();
    double sum = 0, true_sum = 0, apart = 0, lit = 0;
    const size_t pixels = truth->radiance.size();
    for (size_t i = 0; i < pixels; ++i) sum += direct->radiance[i].y, true_sum += truth->radiance[i].y;
    for (size_t i = 0; i < pixels; ++i) {
        apart += std::abs(direct->radiance[i].y - truth->radiance[i].y) >
                 .1 * true_sum / static_cast<double>(pixels);
        lit += truth->radiance[i].y > 0;
    }
    return {sum / true_sum - 1, apart / static_cast<double>(pixels), lit / static_cast<double>(pixels)};
}

void expect_agreement(Device& device, const AnalyticScene& scene, const char* what) {
    const Agreement found = compare(device, scene);
    std::printf("%s: mean %+.2f %%, %.2f %% of the pixels differ, %.0f %% lit\n", what,
                100 * found.mean_error, 100 * found.share_apart, 100 * found.lit);
    EXPECT_LT(std::abs(found.mean_error), .01) << what;
    EXPECT_LT(found.share_apart, .03) << what << ": only edges of shadows";
    EXPECT_GT(found.lit, .2) << what;
    EXPECT_LT(found.lit, .97) << what;
}

TEST_F(DirectLights, PointLightAgreesWithTheReferenceAllAroundIt) {
    AnalyticScene scene = corner_with_block();
    // Beside the block, with surfaces in five of the six directions and shadows across faces of the cube.
    for (const glm::vec3& place :
         {glm::vec3(1.4f, 1.3f, .6f), glm::vec3(.8f, .4f, .5f), glm::vec3(1, 1, 1.6f)}) {
        scene.lights = {point_light(place, 5)};
        expect_agreement(*device, scene, "point");
    }
}

TEST_F(DirectLights, DirectionalLightAgreesWithTheReferenceAtAnyAngle) {
    AnalyticScene scene = corner_with_block();
    for (const glm::vec3& direction :
         {glm::vec3(0, 0, -1), glm::vec3(-1, -.8f, -.7f), glm::vec3(-.2f, -1, -.3f)}) {
        scene.lights = {sharp_sun(direction, 3)};
        expect_agreement(*device, scene, "directional");
    }
}

TEST_F(DirectLights, SpotAgreesWithTheReference) {
    AnalyticScene scene = corner_with_block();
    scene.lights = {scenes::spot(glm::vec3(1.8f, 1.6f, 1.7f), glm::vec3(.5f, .6f, .4f), .7f, .4f, 12)};
    expect_agreement(*device, scene, "spot");
}

TEST_F(DirectLights, SeveralLightsOfAllKindsAddUp) {
    AnalyticScene scene = corner_with_block();
    scene.lights = {point_light(glm::vec3(1.4f, 1.3f, .6f), 2), sharp_sun(glm::vec3(-1, -.8f, -.7f), 1),
                    scenes::spot(glm::vec3(1.8f, 1.6f, 1.7f), glm::vec3(.5f, .6f, .4f), .7f, .4f, 5)};
    expect_agreement(*device, scene, "three lights");
}

TEST_F(DirectLights, VplGivesTheSameDirectLight) {
    AnalyticScene scene = corner_with_block();
    scene.lights = {point_light(glm::vec3(1.4f, 1.3f, .6f), 2), sharp_sun(glm::vec3(-1, -.8f, -.7f), 1)};
    const auto direct = scenes::render(*device, "direct", scene), vpl = scenes::render(*device, "vpl", scene);
    ASSERT_TRUE(direct && vpl);
    for (size_t i = 0; i < direct->radiance.size(); ++i)
        ASSERT_NEAR(direct->radiance[i].y, vpl->radiance[i].y, 1e-5f) << i;
}

TEST_F(DirectLights, SealedRoomStaysBlackUnderAnyLightOutside) {
    AnalyticScene scene;
    scene.surfels = scenes::closed_box(1, 60, glm::vec3(.9f));
    scene.camera = scenes::look(glm::vec3(.5f), glm::vec3(.9f, .8f, .4f), .8f, 64);
    scene.settings.set(kOnlyBounce, 0);
    scene.lights = {point_light(glm::vec3(.5f, .5f, 1.3f), 1000),
                    point_light(glm::vec3(-.2f, .4f, .3f), 1000), sharp_sun(glm::vec3(-.3f, .2f, -1), 1000),
                    sharp_sun(glm::vec3(1, .3f, .1f), 1000)};
    const auto direct = scenes::render(*device, "direct", scene);
    ASSERT_TRUE(direct) << direct.error().line();
    for (size_t i = 0; i < direct->radiance.size(); ++i) ASSERT_EQ(direct->radiance[i].y, 0) << i;
}

TEST_F(DirectLights, EnvironmentIsSeenWhereNothingIs) {
    AnalyticScene scene = corner_with_block();
    auto sky = std::make_shared<Environment>();
    *sky = {64, 32, std::vector<glm::vec3>(64 * 32), .7f};
    for (size_t i = 0; i < sky->texels.size(); ++i) sky->texels[i] = glm::vec3(static_cast<float>(i % 61));
    scene.environment = sky;
    scene.camera = scenes::look(glm::vec3(3, 3, 2), glm::vec3(-1, 1, 4), 1, 96);
    const auto direct = scenes::render(*device, "direct", scene),
               truth = scenes::render(*device, "reference", scene);
    ASSERT_TRUE(direct && truth);
    size_t empty = 0, same = 0;
    for (size_t i = 0; i < direct->texels.size(); ++i) {
        if (direct->texels[i].depth > 0) continue;
        ++empty;
        same += direct->radiance[i].x == truth->radiance[i].x;
    }
    EXPECT_GT(empty, 1000u);
    EXPECT_GE(same, empty * 98 / 100) << "but for rounding at the edges of texels";
}

}  // namespace
}  // namespace lucarne::gi
