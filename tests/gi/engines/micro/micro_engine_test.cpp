#include <cmath>
#include <limits>

#include <gtest/gtest.h>

#include "gi/bounce_options.h"
#include "gi/compare/metrics.h"
#include "gi/engines/reference/options.h"
#include "gi/gather/gather_options.h"
#include "gi/lighting/light_options.h"
#include "io/core/random.h"
#include "tests/gi/engines/analytic_frame.h"
#include "tests/gi/engines/glossy_corner.h"
#include "tests/gi/engines/surfel_scenes.h"
#include "tests/gi/on_device.h"

namespace lucarne::gi {
namespace {

using scenes::AnalyticScene, scenes::look, scenes::material, scenes::spot;

class MicroEngineTest : public OnDevice {
 protected:
    Lit render(const AnalyticScene& scene, std::string_view engine = "micro", uint64_t index = 0) {
        auto rendered = scenes::render(*device, engine, scene, index);
        EXPECT_TRUE(rendered) << rendered.error().line();
        return rendered ? std::move(*rendered) : Lit{};
    }
};

/// A room with a lit ceiling, seen so that a wall and the floor fill the picture.
AnalyticScene room(const Material& surface) {
    AnalyticScene scene;
    scene.surfels = scenes::closed_box(2, 60, glm::vec3(0.5f));
    for (Surfel& s : scene.surfels)
        if (s.position.z > 1.99f && std::abs(s.position.x - 1) < .4f && std::abs(s.position.y - 1) < .4f)
            s.material = 1;
    scene.materials = {surface, material(1, 0, 1, 5)};
    scene.camera = look(glm::vec3(0.4f, 0.4f, 1.2f), glm::vec3(1.4f, 1.4f, 0.1f), 0.7f, 48);
    scene.settings.set(kOnlyBounce, 1);
    scene.settings.set(kMicroBuffer, 24);
    scene.settings.set(kGatherEvery, 1);
    scene.settings.set(reference::kSamples, 256);
    return scene;
}

TEST_F(MicroEngineTest, GlossyWallsReflectALampAsInTheReference) {
    for (const float exponent : {1.0f, 10.0f, 100.0f}) {
        const AnalyticScene scene = room(material(0.5f, 0.4f, exponent, 0));
        const double found = mean_luminance(render(scene).radiance);
        EXPECT_NEAR(found / mean_luminance(render(scene, "reference").radiance), 1, 0.03) << exponent;
    }
}

// Senders that spread their specular light evenly made this a third too bright.
TEST_F(MicroEngineTest, GlossySendersSendTheLightOfASpotWhereTheirLobesPoint) {
    for (const float exponent : {10.0f, 100.0f}) {
        AnalyticScene scene = scenes::glossy_corner(exponent);
        scene.settings.set(kMicroBuffer, 24);
        scene.settings.set(kGatherEvery, 1);
        scene.settings.set(reference::kSamples, 128);
        const double truth = mean_luminance(render(scene, "reference").radiance);
        EXPECT_NEAR(mean_luminance(render(scene).radiance) / truth, 1, 0.04) << exponent;
    }
}

/// A side wall beside a dark wall, in which there is a window whose reveals shine on its pane.
AnalyticScene window_reveal() {
    constexpr int kSurfelsAMetre = 60;
    const auto add = [](AnalyticScene& scene, const glm::vec3& corner, const glm::vec3& u, const glm::vec3& v,
                        uint32_t material) {
        scenes::add_rectangle(scene.surfels, corner, u, v,
                              static_cast<int>(std::lround(glm::length(u) * kSurfelsAMetre)), glm::vec3(0.5f),
                              material);
    };
    // Discs have a seventh of the depth as radius. Less depth is nothing to compare with: rays start a radius
    // above the surface.
    constexpr float kDepth = 0.2f, kSide = 0.8f, kLow = 0.6f, kHigh = kLow + kSide;
    AnalyticScene scene;
    add(scene, kO, 2.0f * kZ, 2.0f * kX, 0);
    std::erase_if(scene.surfels, [](const Surfel& s) {
        return std::abs(s.position.x - 1) < kSide / 2 && std::abs(s.position.z - 1) < kSide / 2;
    });
    add(scene, kO, 2.0f * kY, 2.0f * kZ, 0);
    add(scene, {kLow, -kDepth, kLow}, kSide * kZ, kSide * kX, 0);
    for (float at = kLow; at < kHigh - kDepth / 2; at += kDepth) {
        add(scene, {kLow, -kDepth, at}, kDepth * kY, kDepth * kZ, 1);
        add(scene, {kHigh, -kDepth, at}, kDepth * kZ, kDepth * kY, 1);
        add(scene, {at, -kDepth, kLow}, kDepth * kX, kDepth * kY, 1);
        add(scene, {at, -kDepth, kHigh}, kDepth * kY, kDepth * kX, 1);
    }
    scene.materials = {material(1, 0, 1, 0), material(1, 0, 1, 5)};
    scene.camera = look(glm::vec3(1.8f, 1.2f, 1), glm::vec3(0, 0.7f, 1), 0.5f, 48);
    return scene;
}

// A place that held a part of the wall and of the pane had the light of either: in single frames a third more
// than there is.
TEST_F(MicroEngineTest, PlacesDoNotJoinTheLightOfAWindowWithTheWallAboutIt) {
    AnalyticScene scene = window_reveal();
    scene.settings.set(kOnlyBounce, 2);
    scene.settings.set(kMicroBuffer, 24);
    scene.settings.set(kGatherEvery, 1);
    scene.settings.set(reference::kSamples, 256);
    const double truth = mean_luminance(render(scene, "reference").radiance);
    scene.settings.set(kRadiosityLevel, 10);
    EXPECT_NEAR(mean_luminance(render(scene).radiance) / truth, 1, 0.05);
    // Few places for a window find its light by chance, but their mean is right.
    constexpr uint64_t kFrames = 8;
    for (const uint32_t level : {6u, 8u}) {
        scene.settings.set(kRadiosityLevel, level);
        double mean = 0;
        for (uint64_t index = 0; index < kFrames; ++index)
            mean += mean_luminance(render(scene, "micro", index).radiance) / kFrames;
        EXPECT_NEAR(mean / truth, 1, 0.1) << level;
    }
}

// In gaps of scans shares of the surface have little to do with the area that light meets.
TEST_F(MicroEngineTest, SharesOfSurfelsDoNotChangeTheLightOfPhotonsAndVpls) {
    for (const LightPoints points : {LightPoints::photons, LightPoints::vpls}) {
        AnalyticScene scene = room(material(1, 0, 1, 0));
        scene.settings.set(kOnlyBounce, 3);
        scene.settings.set(kLightPoints, points);
        scene.settings.set(kPhotons, 262'144);
        const double even = mean_luminance(render(scene).radiance);
        for (Surfel& s : scene.surfels)
            if (s.position.x + s.position.y > 2) s.area *= 0.1f;
        EXPECT_NEAR(mean_luminance(render(scene).radiance) / even, 1, 0.02) << static_cast<int>(points);
    }
}

// Radiosity, which spreads specular light evenly between surfaces, makes this 1.75 and 2 times as bright as
// it is. Sums of lobes lose less below the surface than the lobes of each photon.
TEST_F(MicroEngineTest, LightIsReflectedByLobesBetweenSurfaces) {
    for (const LightPoints points : {LightPoints::photons, LightPoints::vpls})
        for (const float exponent : {10.0f, 100.0f}) {
            AnalyticScene scene = scenes::glossy_corner(exponent);
            scene.settings.set(kOnlyBounce, 2);
            scene.settings.set(kMicroBuffer, 24);
            scene.settings.set(kGatherEvery, 2);
            scene.settings.set(kLightPoints, points);
            scene.settings.set(kVpls, 4096);
            scene.settings.set(reference::kSamples, 128);
            const double truth = mean_luminance(render(scene, "reference").radiance);
            EXPECT_NEAR(mean_luminance(render(scene).radiance) / truth, 1, 0.17)
                << static_cast<int>(points) << ", exponent " << exponent;
        }
}

TEST_F(MicroEngineTest, FewerGatheringPixelsGiveTheSameLight) {
    AnalyticScene scene = room(material(1, 0, 1, 0));
    const auto all = render(scene);
    for (const uint32_t every : {2u, 4u}) {
        scene.settings.set(kGatherEvery, every);
        const auto some = render(scene);
        EXPECT_NEAR(mean_luminance(some.radiance) / mean_luminance(all.radiance), 1, 0.01) << every;
        double points = 0;
        for (const auto& [name, value] : some.stats)
            if (name == "gather_points") points = value;
        EXPECT_LT(points, 48 * 48 * 0.6);
    }
}

TEST_F(MicroEngineTest, SmallMicroBuffersGiveTheSameLightOnAverage) {
    AnalyticScene scene = room(material(1, 0, 1, 0));
    const double fine = mean_luminance(render(scene).radiance);
    scene.settings.set(kMicroBuffer, 8);
    EXPECT_NEAR(mean_luminance(render(scene).radiance) / fine, 1, 0.03);
}

TEST_F(MicroEngineTest, SurfelsWithoutNormalsShineByThePlaneThatTheyLieIn) {
    AnalyticScene scene = room(material(1, 0, 1, 0));
    const double with_normals = mean_luminance(render(scene).radiance);
    for (Surfel& s : scene.surfels)
        if (s.position.z > 1.99f) s.normal = glm::vec3(0.0f);
    EXPECT_NEAR(mean_luminance(render(scene).radiance) / with_normals, 1, 0.03);
}

TEST_F(MicroEngineTest, HugeEmissionIsFinite) {
    AnalyticScene scene = room(material(1, 0, 1, 0));
    const double mean = mean_luminance(render(scene).radiance);
    scene.materials[1] = material(1, 0, 1, 5e12f);
    EXPECT_NEAR(mean_luminance(render(scene).radiance) / mean, 1e12, 1e9);
}

TEST_F(MicroEngineTest, OneSurfelIsASceneToo) {
    AnalyticScene scene = room(material(1, 0, 1, 0));
    scene.surfels.resize(1);
    for (const glm::vec4& pixel : render(scene).radiance) ASSERT_EQ(glm::vec3(pixel), glm::vec3(0.0f));
}

TEST_F(MicroEngineTest, ACameraInAWallGivesFinitePictures) {
    AnalyticScene scene = room(material(1, 0, 1, 0));
    scene.camera = look(glm::vec3(0.0f, 1, 1), glm::vec3(1, 1.2f, 1), 0.7f, 32);
    for (const glm::vec4& pixel : render(scene).radiance) ASSERT_TRUE(std::isfinite(pixel.x));
}

// Discs at the foot of a wall reach through it. What lies behind it counted as lit surface, and a tenth of
// the light was lost.
TEST_F(MicroEngineTest, PhotonsAndVplsLoseNoLightInCornersOfNoisyRooms) {
    AnalyticScene scene;
    scene.surfels = scenes::closed_box(2, 40, glm::vec3(0.5f));
    Random random(7);
    for (Surfel& s : scene.surfels)
        s.position += s.normal * (0.3f * s.radius * static_cast<float>(random.uniform() - 0.5));
    scene.lights = {spot({0.6f, 1, 1.6f}, {1, 1, 0}, 0.7f, 0.5f, 5)};
    scene.camera = look(glm::vec3(0.4f, 0.4f, 1.2f), glm::vec3(1.4f, 1.4f, 0.9f), 0.7f, 48);
    scene.settings.set(kOnlyBounce, 2);
    scene.settings.set(kMicroBuffer, 24);
    scene.settings.set(kGatherEvery, 2);
    scene.settings.set(kPhotons, 1'048'576);
    scene.settings.set(kVpls, 1024);
    scene.settings.set(reference::kSamples, 256);
    const double truth = mean_luminance(render(scene, "reference").radiance);
    for (const LightPoints points : {LightPoints::photons, LightPoints::vpls}) {
        scene.settings.set(kLightPoints, points);
        EXPECT_NEAR(mean_luminance(render(scene).radiance) / truth, 1, 0.045)
            << kLightPointKinds[static_cast<size_t>(points)];
    }
}

}  // namespace
}  // namespace lucarne::gi
