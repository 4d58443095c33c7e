// VPLs are chosen by what their light adds to the picture.
#include "gi/engines/vpl/view_importance/view_importance.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <limits>
#include <random>

#include <gtest/gtest.h>

#include "gi/bounce_options.h"
#include "gi/compare/metrics.h"
#include "gi/engines/vpl/options.h"
#include "gi/lighting/light_options.h"
#include "gi/registry.h"
#include "tests/gi/engines/lit_scene.h"
#include "tests/gi/engines/surfel_scenes.h"
#include "tests/gi/on_device.h"

namespace lucarne::gi::vpl {
namespace {

struct Candidates {
    std::vector<VplLight> lights;
    std::vector<float> importance, nearness;
};

/// Candidates of uneven flux; their x coordinate is their number. Every seventh is dead.
Candidates make_candidates(size_t count) {
    Candidates made;
    std::mt19937 random(3), near(4);
    std::uniform_real_distribution<float> uniform(0.1f, 1);
    for (size_t i = 0; i < count; ++i) {
        const float flux = uniform(random);
        made.lights.push_back(i % 7 == 0
                                  ? kDeadLight
                                  : VplLight{glm::vec4(static_cast<float>(i), 0, 0, 0.5f),
                                             glm::vec4(0, 0, 1, 0.01f), glm::vec4(glm::vec3(flux / 6), 1),
                                             glm::vec4(glm::vec3(flux), 1), glm::vec4(0, 0, 1, 0)});
        made.importance.push_back(std::pow(uniform(random), 6.0f));
        made.nearness.push_back(std::pow(uniform(near), 3.0f));
    }
    return made;
}

TEST(DrawCandidates, KeepsFluxAndFootprintOnTheMean) {
    const Candidates from = make_candidates(2000);
    double flux = 0, footprint = 0;
    for (const VplLight& light : from.lights) flux += light.flux.x, footprint += light.position.w;
    double drawn_flux = 0, drawn_footprint = 0;
    constexpr int kRuns = 400;
    for (int run = 0; run < kRuns; ++run)
        for (const VplLight& light : draw_candidates(from.lights, from.importance, from.nearness, 64, run)) {
            drawn_flux += light.flux.x / kRuns;
            drawn_footprint += light.position.w / kRuns;
        }
    EXPECT_NEAR(drawn_flux, flux, 0.02 * flux);
    EXPECT_NEAR(drawn_footprint, footprint, 0.03 * footprint);
}

TEST(DrawCandidates, KeepsTheOrderAndPrefersImportantLight) {
    const Candidates from = make_candidates(2000);
    const std::vector<float> nowhere_near(2000);
    const auto drawn = draw_candidates(from.lights, from.importance, nowhere_near, 256, 1);
    ASSERT_EQ(drawn.size(), 256u);
    double mean = 0, drawn_mean = 0;
    for (const float value : from.importance) mean += value / 2000;
    for (size_t i = 0; i < drawn.size(); ++i) {
        ASSERT_GT(drawn[i].flux.w, 0) << "a dead candidate was drawn";
        if (i > 0) {
            EXPECT_GE(drawn[i].position.x, drawn[i - 1].position.x);
        }
        drawn_mean += from.importance[static_cast<size_t>(drawn[i].position.x)] / 256;
    }
    EXPECT_GT(drawn_mean, 3 * mean);
    double beside_mean = 0;  // two in ten are drawn by a nearness that has nothing to do with importance
    for (const VplLight& light : draw_candidates(from.lights, from.importance, from.nearness, 256, 1))
        beside_mean += from.importance[static_cast<size_t>(light.position.x)] / 256;
    EXPECT_GT(beside_mean, 2.5 * mean);
}

TEST(DrawCandidates, WithoutUsableImportanceTheLightDecides) {
    Candidates from = make_candidates(700);
    for (const float value : {0.0f, -1.0f, std::numeric_limits<float>::quiet_NaN()}) {
        from.importance.assign(700, value);
        double flux = 0, drawn_flux = 0;
        for (const VplLight& light : from.lights) flux += light.flux.x;
        for (const VplLight& light : draw_candidates(from.lights, from.importance, from.nearness, 64, 1))
            drawn_flux += light.flux.x;
        EXPECT_NEAR(drawn_flux, flux, 1e-3 * flux);  // every VPL holds the same share
    }
    const std::vector<VplLight> dead(100, kDeadLight);
    const std::vector<float> even(100, 1.0f);
    for (const VplLight& light : draw_candidates(dead, even, even, 8, 1)) EXPECT_EQ(light.flux.w, 0);
}

// A ledge beside what the camera sees, which no importon sees, while most light falls on the roof: by light
// alone a VPL on the ledge held a hundredth of all light, and showed as a bright line.
TEST(DrawCandidates, LightInANicheBesideTheViewIsSharedOut) {
    std::vector<VplLight> lights(3000, make_candidates(2).lights[1]);
    std::vector<float> importance(3000), nearness(3000);
    for (size_t i = 0; i < 3000; ++i) {
        const bool roof = i < 2000, ledge = i >= 2900;
        lights[i].position.x = static_cast<float>(i);
        if (roof) lights[i].diffuse *= 50.0f, lights[i].flux *= 50.0f;
        importance[i] = roof || ledge ? 0 : 1;
        nearness[i] = roof ? 0 : 1;
    }
    double all = 0, ledge = 0;
    for (const VplLight& light : lights) all += light.flux.x;
    for (size_t i = 2900; i < 3000; ++i) ledge += lights[i].flux.x;
    constexpr int kRuns = 100;
    double drawn = 0, most = 0;
    for (int run = 0; run < kRuns; ++run)
        for (const VplLight& light : draw_candidates(lights, importance, nearness, 256, run)) {
            if (light.position.x < 2900) continue;
            drawn += light.flux.x / kRuns;
            most = std::max<double>(most, light.flux.x);
        }
    EXPECT_NEAR(drawn, ledge, 0.1 * ledge);
    EXPECT_LT(most, 0.3 * ledge);
    EXPECT_LT(most, 1e-3 * all);
}

TEST(Nearness, FollowsTheDistanceOfImportonsOnTheLitSide) {
    VplLight light = kDeadLight;
    light.position = {0, 0, 0, 1};
    light.normal = {0, 0, 1, 0.01f};
    light.flux.w = 1;
    VplLight importon = light;
    const auto nearness = [&](const glm::vec3& at) {
        importon.position = glm::vec4(at, 1);
        std::vector<float> sum(1);
        add_nearness(std::array{light}, std::array{importon}, 0.5f, sum);
        return sum[0];
    };
    EXPECT_FLOAT_EQ(nearness({0, 0, 1}), 1 / 1.25f);
    EXPECT_FLOAT_EQ(nearness({3, 0, 4}), 0.8f / 25.25f);
    EXPECT_EQ(nearness({0, 0, -1}), 0) << "the light is on the other side";
    EXPECT_EQ(nearness({0, 0, 0}), 0);
    importon.flux.w = 0;
    EXPECT_EQ(nearness({0, 0, 1}), 0) << "there is no importon";
}

class ViewVpls : public OnDevice {
 protected:
    double lit_mean(const SurfelCloud& cloud, const CameraView& camera, const LitOptions& options) {
        return mean_luminance(light_up(*device, **make_engine("vpl"), cloud, camera, options).radiance);
    }
    std::vector<double> means(const SurfelCloud& cloud, LitOptions options, const CameraView& camera,
                              bool view_vpls) {
        options.settings.set(kViewVpls, view_vpls);
        std::vector<double> found;
        for (uint32_t seed = 0; seed < 8; ++seed) {
            options.settings.set(kSeed, seed);
            found.push_back(lit_mean(cloud, camera, options));
        }
        return found;
    }
};

double mean(const std::vector<double>& values) {
    double sum = 0;
    for (const double value : values) sum += value;
    return sum / static_cast<double>(values.size());
}
double deviation(const std::vector<double>& values) {
    double squares = 0;
    for (const double value : values) squares += (value - mean(values)) * (value - mean(values));
    return std::sqrt(squares / static_cast<double>(values.size()));
}

TEST_F(ViewVpls, RoomBesideABrightYardHasLittleNoiseAndTheSameLight) {
    auto surfels = scenes::closed_box(2, 50, glm::vec3(.5f));
    scenes::add_rectangle(surfels, {-12, -12, -1}, {24, 0, 0}, {0, 24, 0}, 120, glm::vec3(.5f));
    const SurfelCloud cloud(std::move(surfels), {{-16, -16, -16}, 32});
    LitOptions options;
    options.lights = {scenes::spot({1, 1, 1.8f}, {1, 1, 0}, .6f, .6f, 5),
                      scenes::spot({8, 8, 4}, {8, 8, -1}, .9f, .9f, 400)};
    options.settings.set(kOnlyBounce, 1);
    options.settings.set(kVpls, 64);
    options.settings.set(kAtlas, 512);
    const CameraView camera = look({.3f, .4f, .5f}, {1.2f, 1.3f, .9f}, 48, 48);
    const auto plain = means(cloud, options, camera, false), chosen = means(cloud, options, camera, true);
    // .3 to .45, depending on the random numbers: a deviation of eight values is itself uncertain by a
    // quarter.
    EXPECT_LT(deviation(chosen) / mean(chosen), 0.5 * deviation(plain) / mean(plain));
    EXPECT_NEAR(mean(chosen), mean(plain), 3 * deviation(plain) / std::sqrt(8.0));
}

TEST_F(ViewVpls, LightOfTheSkyThroughAWindowHasLittleNoiseAndThatOfTheReference) {
    auto room = scenes::closed_box(2, 50, glm::vec3(.5f));
    std::erase_if(room, [](const Surfel& s) {  // a window of .5 m in the wall at x = 2
        return s.position.x > 1.99f && std::abs(s.position.y - 1.2f) < .25f &&
               std::abs(s.position.z - 1.3f) < .25f;
    });
    const SurfelCloud cloud(std::move(room), {{-1, -1, -1}, 4});
    LitOptions options;
    auto sky = std::make_shared<Environment>();
    sky->texels = {glm::vec3(10.0f)};
    options.environment = sky;
    options.settings.set(kOnlyBounce, 1);
    options.settings.set(kVpls, 64);
    options.settings.set(kAtlas, 512);
    options.settings.set(kLightSamples, 16);
    const CameraView camera = look({1.8f, 1, 1}, {.2f, .9f, .4f}, 48, 48);
    const auto plain = means(cloud, options, camera, false), chosen = means(cloud, options, camera, true);
    EXPECT_GT(mean(plain), 0);
    EXPECT_LT(deviation(chosen) / mean(chosen), 0.4 * deviation(plain) / mean(plain));
    // It was 1.9 times as bright when rims above the roof gave their flux to the room.
    const double truth =
        mean_luminance(light_up(*device, **make_engine("reference"), cloud, camera, options).radiance);
    EXPECT_NEAR(mean(chosen), truth, .2 * truth);
}

/// A level square with noise of its heights, in radii, and of its normals, in radians.
std::vector<Surfel> noisy_sheet(float side, int n, float height_noise, float tilt) {
    std::vector<Surfel> surfels;
    scenes::add_rectangle(surfels, {-side / 2, -side / 2, 0}, {side, 0, 0}, {0, side, 0}, n, glm::vec3(.8f));
    std::mt19937 random(5);
    std::normal_distribution<float> normal;
    for (Surfel& s : surfels) {
        s.position.z += height_noise * s.radius * normal(random);
        s.normal = glm::normalize(s.normal + tilt * glm::vec3(normal(random), normal(random), 0));
    }
    return surfels;
}

TEST_F(ViewVpls, NoisyFloorDoesNotLightItself) {
    const SurfelCloud cloud(noisy_sheet(16, 200, 0.3f, 0.04f), {{-16, -16, -16}, 32});
    LitOptions options;
    options.lights = {scenes::spot({-5, 0, 2}, {-5, 0, 0}, .6f, .6f, 100)};
    options.settings.set(kVpls, 256);
    options.settings.set(kOnlyBounce, 0);
    const double lit = lit_mean(cloud, look({-5, .1f, 2}, {-5, 0, 0}, 48, 48), options);
    options.settings.set(kOnlyBounce, 1);
    const double far = lit_mean(cloud, look({4, .1f, 2}, {4, 0, 0}, 48, 48), options);
    EXPECT_GT(lit, 1);
    EXPECT_LT(far, 3e-6 * lit);  // without the rule 4.8e-6
}

TEST_F(ViewVpls, LampOverANoisyRoofDoesNotLightTheCeilingUnderIt) {
    auto sheet = noisy_sheet(16, 200, 1, 0.04f);
    for (Surfel& s : sheet) {  // shallow arches
        s.position.z += 0.15f * std::sin(3 * s.position.x);
        s.normal = glm::normalize(s.normal - glm::vec3(0.45f * std::cos(3 * s.position.x), 0, 0));
    }
    const SurfelCloud cloud(std::move(sheet), {{-16, -16, -16}, 32});
    LitOptions options;
    options.lights = {scenes::spot({0, 0, 2}, {0, 0, 0}, .9f, .9f, 100)};
    options.settings.set(kVpls, 256);
    options.settings.set(kOnlyBounce, 0);
    const double above = lit_mean(cloud, look({0, .1f, 2}, kO, 48, 48), options);
    options.settings.set(kOnlyBounce, 1);
    const double below = lit_mean(cloud, look({0, .1f, -2}, kO, 48, 48), options);
    EXPECT_GT(above, 1);
    EXPECT_LT(below, 1e-4 * above) << below / above;  // without the rule 1.6e-3
}

}  // namespace
}  // namespace lucarne::gi::vpl
