// Glossy surfaces lit by VPLs: energy, fireflies, caustics.
#include <algorithm>
#include <cmath>

#include <gtest/gtest.h>

#include "gi/bounce_options.h"
#include "gi/compare/metrics.h"
#include "gi/engines/reference/options.h"
#include "gi/engines/vpl/options.h"
#include "gi/lighting/light_options.h"
#include "tests/gi/engines/analytic_frame.h"
#include "tests/gi/engines/glossy_corner.h"
#include "tests/gi/engines/surfel_scenes.h"
#include "tests/gi/on_device.h"

namespace lucarne::gi::vpl {
namespace {

using scenes::AnalyticScene, scenes::add_rectangle, scenes::glossy_corner, scenes::look, scenes::material,
    scenes::spot;

class VplGlossyTest : public OnDevice {
 protected:
    Lit render(const AnalyticScene& scene, std::string_view engine = "vpl", uint64_t index = 0) {
        auto rendered = scenes::render(*device, engine, scene, index);
        EXPECT_TRUE(rendered) << rendered.error().line();
        return rendered ? *rendered : Lit{};
    }
    double mean(const AnalyticScene& scene, std::string_view engine = "vpl") {
        return mean_luminance(render(scene, engine).radiance);
    }
};

TEST_F(VplGlossyTest, theGlossyFurnaceReturnsNoMoreThanItsLobesMay) {
    AnalyticScene scene;
    scene.surfels = scenes::closed_box(2, 80, glm::vec3(.3f));
    scene.camera = look(glm::vec3(.3f, .4f, .5f), glm::vec3(1.2f, 1.3f, .9f), 1, 32);
    scene.settings.set(kVpls, 1024);
    scene.settings.set(vpl::kInterleave, 1);
    for (const float exponent : {10.0f, 1000.0f}) {
        scene.materials = {material(1, .3f, exponent, 1)};
        // What a lobe would reflect if none of it were below the horizon.
        const double most = .3 + .3 * (exponent + 2) / (exponent + 1);
        double bound = 1, power = 1;
        for (const uint32_t bounces : {1u, 2u}) {
            power *= most;
            bound += power;
            scene.settings.set(kBounces, bounces);
            const double radiance = mean(scene);
            EXPECT_LT(radiance, 1.02 * bound) << exponent << ", " << bounces;
            EXPECT_NEAR(radiance / mean(scene, "reference"), 1, .04) << exponent << ", " << bounces;
        }
    }
}

TEST_F(VplGlossyTest, aSingleFrameOfFewVplsDoesNotSparkle) {
    for (const float exponent : {10.0f, 100.0f, 1000.0f}) {
        AnalyticScene scene = glossy_corner(exponent);
        scene.settings.set(kVpls, 256);
        scene.settings.set(vpl::kAtlas, 1024);
        scene.settings.set(vpl::kInterleave, 4);
        scene.settings.set(reference::kSamples, 128);
        // Take the mean of the reference over 4 x 4 pixels, because a path tracer has fireflies of its own.
        const auto truth = render(scene, "reference").radiance;
        constexpr size_t kPictureSide = 64, kBlock = 4;
        double brightest = 0;
        for (size_t y = 0; y < kPictureSide; y += kBlock)
            for (size_t x = 0; x < kPictureSide; x += kBlock) {
                double sum = 0;
                for (size_t i = 0; i < kBlock * kBlock; ++i)
                    sum += luminance(truth[(y + i / kBlock) * kPictureSide + x + i % kBlock]);
                brightest = std::max(brightest, sum / (kBlock * kBlock));
            }
        for (const glm::vec4& pixel : render(scene).radiance)
            ASSERT_LT(luminance(pixel), 3 * brightest) << exponent;
    }
}

TEST_F(VplGlossyTest, lobesOfAllWidthsAgreeWithTheReference) {
    for (const float exponent : {10.0f, 100.0f, 1000.0f}) {
        AnalyticScene scene = glossy_corner(exponent);
        scene.settings.set(kVpls, 1024);
        scene.settings.set(vpl::kInterleave, 1);
        scene.settings.set(reference::kSamples, 64);
        EXPECT_NEAR(mean(scene) / mean(scene, "reference"), 1, .05) << exponent;
    }
}

/// A lamp stands 1.5 m in front of a mirror of focal length 1 m. Its image is 3 m away, on a wall behind the
/// lamp.
constexpr float kExponent = 1000, kMirror = .8f, kImage = 3, kWall = 1.2f;
AnalyticScene mirror_and_wall() {
    AnalyticScene scene;
    const glm::vec3 corner(-kWall / 2, -kWall / 2, kImage);
    add_rectangle(scene.surfels, corner, glm::vec3(0, kWall, 0), glm::vec3(kWall, 0, 0), 100, glm::vec3(.5f));
    const float area = scene.surfels[0].area, radius = scene.surfels[0].radius, step = std::sqrt(area);
    for (float x = -.3f; x < .3f; x += step)
        for (float y = -.3f; y < .3f; y += step) {
            const float r2 = x * x + y * y;  // z = r^2 / (4 f)
            if (r2 < .09f)
                scene.surfels.push_back({glm::vec3(x, y, r2 / 4),
                                         glm::normalize(glm::vec3(-x / 2, -y / 2, 1)), glm::vec3(.5f), radius,
                                         area, 1});
        }
    scene.materials = {material(1, 0, 1, 0), material(0, kMirror, kExponent, 0)};
    scene.lights = {spot(glm::vec3(0, 0, 1.5f), glm::vec3(0.0f), .3f, .25f, 10)};
    scene.camera = look(glm::vec3(0, 0, 1.6f), glm::vec3(0, 0, kImage), .43f, 96);
    scene.settings.set(kOnlyBounce, 1);
    return scene;
}

/// The light that lands on the wall that fills the picture: flux, W, and its middle and the variance about
/// it, m and m^2.
struct Landed {
    double flux = 0, variance = 0;
    glm::dvec2 middle{0.0};
};
Landed landed(const AnalyticScene& scene, const Lit& rendered) {
    Landed all;
    const double side = 2 * .43 * (kImage - 1.6) / scene.camera.width;
    double squares = 0;
    for (size_t p = 0; p < rendered.radiance.size(); ++p) {
        if (!(rendered.texels[p].depth > 0)) continue;
        const double flux = rendered.radiance[p].y * M_PI / .5 * side * side;
        const glm::dvec2 at(scenes::position_of(scene.camera, rendered.texels, p));
        all.flux += flux;
        all.middle += flux * at;
        squares += flux * dot(at, at);
    }
    all.middle /= all.flux;
    all.variance = (squares / all.flux - dot(all.middle, all.middle)) / 2;
    return all;
}

TEST_F(VplGlossyTest, aCausticHasItsPlaceItsEnergyAndWithTheFramesItsWidth) {
    AnalyticScene scene = mirror_and_wall();
    scene.settings.set(reference::kSamples, 256);
    const Landed truth = landed(scene, render(scene, "reference"));
    const Landed first = landed(scene, render(scene)), later = landed(scene, render(scene, "vpl", 1000));
    for (const Landed& light : {first, later}) {
        EXPECT_NEAR(light.flux / truth.flux, 1, .04);
        EXPECT_LT(glm::length(light.middle), .03);
    }
    // A Gaussian of the lobe's width; in single frames footprints widen it.
    const double lobe = kImage * kImage / kExponent;
    EXPECT_LT(later.variance, 1.25 * lobe);
    EXPECT_GT(later.variance, .8 * lobe);
    EXPECT_LT(later.variance, first.variance);
}

}  // namespace
}  // namespace lucarne::gi::vpl
