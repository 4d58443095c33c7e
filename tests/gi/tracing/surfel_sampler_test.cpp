#include "gi/tracing/surfel_sampler.h"

#include <algorithm>
#include <cmath>
#include <vector>

#include <gtest/gtest.h>

#include "tests/gi/engines/reference/reference_scene.h"

namespace lucarne::gi::tracing {
namespace {

using reference::material;
using reference::MeanLuminance;
using reference::PathSettings;
using reference::point;
using reference::spot;
using reference::Start;
using reference::starts_on;
using reference::traced;
using reference::tracer_of;
using scenes::wide_sun;

float gauss(Random& random) {
    return static_cast<float>(std::sqrt(-2 * std::log(1 - random.uniform())) *
                              std::cos(2 * M_PI * random.uniform()));
}

/// A room 4 m wide. Points are off their walls by Gaussian noise of `noise` spacings, and normals are bent
/// by `bend`.
std::vector<Surfel> room(float noise, float bend, float coverage) {
    auto surfels = scenes::closed_box(4, 100, glm::vec3(.6f));
    Random random(3);
    for (Surfel& s : surfels) {
        s.position += s.normal * (noise * .04f * gauss(random));
        s.normal = glm::normalize(s.normal + bend * glm::vec3(gauss(random), gauss(random), gauss(random)));
        s.radius *= std::sqrt(coverage / scenes::kLatticeCoverage);
    }
    return surfels;
}

std::vector<Start> on_its_floor(int n) {
    return starts_on(kO, kX * 4.0f, kY * 4.0f, n, .03f, glm::vec3(.6f));
}

struct Compared {
    MeanLuminance led, by_brdf;
    double difference() const { return led.mean / by_brdf.mean - 1; }
    double noise() const { return std::hypot(led.standard_error, by_brdf.standard_error) / by_brdf.mean; }
    /// The variance of a path of the BRDF alone over that of a path that samples lit surfels.
    double gain(uint32_t more) const {
        return more * std::pow(by_brdf.standard_error / led.standard_error, 2);
    }
};

/// Compares paths that sample lit surfels with `more` times as many paths of the BRDF alone.
Compared compare(const Illumination& light, PathSettings settings, uint32_t more) {
    Compared result;
    result.led = traced(light, on_its_floor(24), settings);
    settings.sample_lit = false;
    settings.samples *= more;
    settings.seed += 1;
    result.by_brdf = traced(light, on_its_floor(24), settings);
    return result;
}

TEST(SurfelSampler, LampBesideAWallKeepsItsMeanAndLosesItsNoise) {
    const auto tracer = tracer_of(room(0, 0, scenes::kLatticeCoverage));
    const Illumination light(*tracer, {}, {point(glm::vec3(.1f, 2, 2.5f), 1)}, nullptr);
    for (const int32_t only : {1, 2}) {
        const Compared c = compare(light, {.only_bounce = only, .samples = 32}, 64);
        EXPECT_NEAR(c.difference(), 0, 4 * c.noise()) << only;
        EXPECT_LT(c.noise(), .03) << only;
        EXPECT_GT(c.gain(64), 30) << only;  // measured: 360 and 180
    }
}

TEST(SurfelSampler, NoisyDiscsAndBentNormalsLeaveTheMeanAsItIs) {
    for (const auto& [noise, bend] : {std::pair{.25f, 0.0f}, {.25f, .1f}, {.5f, .2f}})
        for (const float coverage : {4.0f, 9.0f}) {
            const auto tracer = tracer_of(room(noise, bend, coverage));
            const Illumination light(*tracer, {}, {point(glm::vec3(2, 1.5f, 3), 1)}, nullptr);
            const Compared c = compare(light, {.only_bounce = 1, .samples = 256}, 4);
            EXPECT_LT(c.noise(), .0025);
            EXPECT_NEAR(c.difference(), 0, .003 + 3 * c.noise()) << noise << " " << bend << " " << coverage;
        }
}

TEST(SurfelSampler, SeveralLightsOfAllSharpKindsOnGlossyWallsKeepTheirMean) {
    auto surfels = room(.25f, .05f, 4);
    std::erase_if(surfels, [](const Surfel& s) { return s.position.z > 3.5f; });  // lets sun in
    const auto tracer = tracer_of(surfels);
    const Illumination light(
        *tracer, {material(1, .3f, 30, 0)},
        {point(glm::vec3(.3f, 2, 2), 1), spot(glm::vec3(3, 3, 3), glm::vec3(4, 2, 1), .5f, .3f, 4),
         wide_sun(glm::vec3(1, .5f, -1), 0, 1)},
        nullptr);
    for (const int32_t only : {1, 3}) {
        const Compared c = compare(light, {.only_bounce = only, .samples = 256}, 4);
        EXPECT_LT(c.noise(), .01) << only;
        EXPECT_NEAR(c.difference(), 0, 4 * c.noise()) << only;
    }
}

TEST(SurfelSampler, DensityIsThatOfTheDirectionsDrawn) {
    // For directions in a cone about an axis, compares the share of draws that count with the integral of
    // the density.
    const auto tracer = tracer_of(room(.25f, .1f, 4));
    std::vector<double> weights(tracer->surfels().size());
    for (size_t i = 0; i < weights.size(); ++i) weights[i] = 1 + static_cast<double>(i % 5);
    const SurfelSampler sampler(*tracer, weights);
    const glm::vec3 eye(1.2f, 1.7f, 1.9f), axis = glm::normalize(glm::vec3(.4f, .3f, -1));
    const float end = 8, cone = .95f;  // m: longer than the room, so that all discs count
    const int count = 100000;
    int within = 0, missed = 0;
    double integral = 0;
    for (int i = 0; i < count; ++i) {
        Random random(9, static_cast<uint64_t>(i));
        const auto [surfel, point] = sampler.draw(random);
        const glm::vec3 to = glm::normalize(point - eye);
        if (glm::dot(to, axis) > cone) {
            ++within;
            missed += !sampler.density(eye, to, 0, end, surfel).crossed;
        }
        glm::vec3 u, v;
        frame_of(axis, u, v);
        const auto z = static_cast<float>(cone + (1 - cone) * random.uniform());
        const auto phi = static_cast<float>(2 * M_PI * random.uniform());
        const float r = std::sqrt(1 - z * z);
        integral +=
            sampler.density(eye, u * (r * std::cos(phi)) + v * (r * std::sin(phi)) + axis * z, 0, end).pdf;
    }
    const double share = static_cast<double>(within) / count;
    EXPECT_LE(missed, within / 500);  // rounding at the discs' rims
    integral *= 2 * M_PI * (1 - cone) / count;
    EXPECT_NEAR(integral, share, 4 * std::sqrt(share / count) + .005 * share);
}

TEST(SurfelSampler, RayCrossesEveryDiscBetweenItsEndsOnce) {
    std::vector<Surfel> stack;
    for (int i = 0; i < 50; ++i)
        stack.push_back({kZ * (.1f * static_cast<float>(i) + .05f), kZ, kO, i % 2 ? .5f : .01f, 1, 0});
    const auto tracer = tracer_of(stack);
    std::vector<uint32_t> crossed;
    tracer->each_crossed(glm::vec3(.1f, 0, 0), kZ, 1, 3, [&](uint32_t i) { crossed.push_back(i); });
    std::ranges::sort(crossed);
    std::vector<uint32_t> wide;
    for (uint32_t i = 11; i < 30; i += 2) wide.push_back(i);
    EXPECT_EQ(crossed, wide);
}

}  // namespace
}  // namespace lucarne::gi::tracing
