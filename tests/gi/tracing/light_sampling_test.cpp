#include "gi/tracing/light_sampling.h"

#include <algorithm>
#include <cmath>
#include <vector>

#include <gtest/gtest.h>

#include "gi/tracing/scatter.h"
#include "tests/gi/engines/reference/reference_scene.h"

namespace lucarne::gi::tracing {
namespace {

using reference::disc_light;
using reference::material;
using reference::MeanLuminance;
using reference::rectangle_light;
using reference::Start;
using reference::starts_on;
using reference::traced;
using reference::tracer_of;
using scenes::even_sky;
using scenes::wide_sun;

TEST(AliasTable, DrawsInProportionToTheWeights) {
    const std::vector<double> weights = {3, 0, 1, .01, 10, 0, 2.5};
    const AliasTable table(weights);
    EXPECT_DOUBLE_EQ(table.total(), 16.51);
    std::vector<double> drawn(weights.size());
    Random random(5);
    const int count = 1'000'000;
    for (int i = 0; i < count; ++i) ++drawn[table.draw(random)];
    double chi_square = 0;
    for (size_t i = 0; i < weights.size(); ++i) {
        const double expected = weights[i] / table.total() * count;
        if (weights[i] > 0)
            chi_square += (drawn[i] - expected) * (drawn[i] - expected) / expected;
        else
            EXPECT_EQ(drawn[i], 0) << i;
    }
    EXPECT_LT(chi_square, 18.5);  // 4 degrees of freedom, one in a thousand
    EXPECT_TRUE(AliasTable(std::vector<double>(9)).empty());
    EXPECT_TRUE(AliasTable({}).empty());
}

/// The light of one source on a diffuse surface of albedo .5, with nothing in the way.
MeanLuminance lit(const Light& light, const Start& start, uint32_t samples = 100000) {
    const auto nothing = tracer_of({});
    const Illumination illumination(*nothing, {}, {light}, nullptr);
    return traced(illumination, {start}, {.bounces = 0, .samples = samples});
}

TEST(LightSampling, RectangleLightsAParallelSquareByTheirFormFactor) {
    for (const auto& [distance, factor] : {std::pair{1.0f, 0.199825}, std::pair{0.5f, 0.415253}}) {
        const auto nothing = tracer_of({});
        const Illumination light(
            *nothing, {}, {rectangle_light(glm::vec3(.5f, .5f, distance), kX * .5f, .5f, -kZ, 2)}, nullptr);
        const auto mean =
            traced(light, starts_on(kO, kX, kY, 64, .002f, glm::vec3(.5f)), {.bounces = 0, .samples = 256});
        EXPECT_LT(mean.standard_error, .001 * factor);
        EXPECT_NEAR(mean.mean, .5 * 2 * factor, .0005 * factor + 4 * mean.standard_error) << distance;
    }
}

TEST(LightSampling, DiscOverItsAxisGivesTheIrradianceOfItsSolidAngle) {
    // E = pi L R^2 / (R^2 + h^2)
    const auto mean = lit(disc_light(kZ * 2.0f, .7f, -kZ, 3), {kO, kZ, kZ, glm::vec3(.5f), .01f, 0});
    const double truth = .5 * 3 * .49 / (.49 + 4);
    EXPECT_NEAR(mean.mean, truth, 1e-6 + 5 * mean.standard_error);
    EXPECT_LT(mean.standard_error, .001 * truth);
}

TEST(LightSampling, AreaLightsShineFromOneSideOnly) {
    const Start start{kO, kZ, kZ, glm::vec3(.5f), .01f, 0};
    EXPECT_EQ(lit(disc_light(kZ, .7f, kZ, 3), start, 100).mean, 0);
    EXPECT_EQ(lit(rectangle_light(kZ, kX, 1, kZ, 3), start, 100).mean, 0);
}

TEST(LightSampling, CapOfSkyGivesItsIrradianceTimesTheCosineWhateverItsRadius) {
    const glm::vec3 away = glm::normalize(glm::vec3(.5f, 0, -1));
    for (const float radius : {0.0f, .00465f, .2f, .8f}) {
        const auto mean = lit(wide_sun(away, radius, 10), {kO, kZ, kZ, glm::vec3(.5f), .01f, 0});
        const double truth = .5 / M_PI * 10 * -away.z;  // the whole cap is above the horizon
        EXPECT_NEAR(mean.mean, truth, 1e-4 * truth + 5 * mean.standard_error) << radius;
        EXPECT_LT(mean.standard_error, .003 * truth) << radius;
    }
}

TEST(LightSampling, HalfTheSunBehindAnEdgeGivesHalfItsLight) {
    std::vector<Surfel> wall;
    scenes::add_rectangle(wall, glm::vec3(0, -2, 2), kX * 4.0f, kY * 4.0f, 400, glm::vec3(.5f));
    const auto tracer = tracer_of(wall);
    const Illumination light(*tracer, {}, {wide_sun(-kZ, .1f, 10)}, nullptr);
    const Start start{kO, kZ, kZ, glm::vec3(.5f), 1e-4f, 0};
    const auto mean = traced(light, {start}, {.bounces = 0, .samples = 40000});
    // The edge of the wall extends .1 of its surfels' spacing too far: .001 of a cap's radius of .2.
    EXPECT_NEAR(mean.mean, .5 * .5 / M_PI * 10, .01 * .8 + 5 * mean.standard_error);
}

/// Returns the radiance of a glossy surface at the origin, by even sampling of the hemisphere.
double by_even_directions(const Reflectance& surface, const glm::vec3& out, const auto& radiance) {
    double sum = 0;
    const int count = 4'000'000;
    for (int i = 0; i < count; ++i) {
        Random random(9, static_cast<uint64_t>(i));
        const double z = random.uniform(), phi = 2 * M_PI * random.uniform(), r = std::sqrt(1 - z * z);
        const glm::vec3 in(r * std::cos(phi), r * std::sin(phi), z);
        sum += brdf(surface, kZ, out, in).x * z * radiance(in) * 2 * M_PI;
    }
    return sum / count;
}

TEST(LightSampling, GlossySurfacesShowAreasSkiesAndCapsWhicheverWayTheyAreSampled) {
    const glm::vec3 out = glm::normalize(glm::vec3(.3f, 0, 1));
    const Light square = rectangle_light(glm::vec3(-.5f, 0, 2), kX * .5f, .8f, -kZ, 2);
    const Light cap = wide_sun(glm::vec3(.4f, 0, -1), .15f, 5);
    auto sky = std::make_shared<Environment>();
    *sky = {16, 8, std::vector<glm::vec3>(128, glm::vec3(.1f)), .3f};
    for (size_t i : {5u, 20u, 21u, 40u, 55u}) sky->texels[i] = glm::vec3(4);
    const auto nothing = tracer_of({});
    for (const float exponent : {1.0f, 10.0f, 100.0f, 1000.0f}) {
        const std::vector<Material> materials = {material(1, .6f, exponent, 0)};
        const Reflectance surface = make_reflectance(materials[0], glm::vec3(.3f));
        const Start start{kO, kZ, out, glm::vec3(.3f), .01f, 0};
        const auto check = [&](const Illumination& light, const auto& radiance, const char* what) {
            const auto mean = traced(light, {start}, {.bounces = 0, .samples = 200000});
            const double truth = by_even_directions(surface, out, radiance);
            EXPECT_NEAR(mean.mean, truth, .01 * truth + 5 * mean.standard_error) << what << " " << exponent;
            EXPECT_LT(mean.standard_error, .01 * truth) << what << " " << exponent;
        };
        const auto along = [](const Light& light) {
            return [light](const glm::vec3& in) {
                const auto found = light_along(light, kO, in);
                return found ? found->radiance.x : 0.0f;
            };
        };
        check(Illumination(*nothing, materials, {square}, nullptr), along(square), "rectangle");
        check(Illumination(*nothing, materials, {cap}, nullptr), along(cap), "cap");
        check(
            Illumination(*nothing, materials, {}, sky),
            [&](const glm::vec3& in) { return sky->radiance(in).x; }, "sky");
    }
}

TEST(LightSampling, WhatIsDrawnHasTheDensityThatIsClaimed) {
    auto sky = std::make_shared<Environment>();
    *sky = {16, 8, std::vector<glm::vec3>(128, glm::vec3(0)), -1.0f};
    for (size_t i : {0u, 5u, 40u, 55u, 127u}) sky->texels[i] = glm::vec3(static_cast<float>(i + 1));
    const EnvironmentSampler sampler(sky);
    const Light lights[] = {rectangle_light(kZ * 2.0f, kX * .5f, .8f, -kZ, 2), disc_light(kZ, .7f, -kZ, 3),
                            wide_sun(-kZ, .3f, 5)};
    double mean_inverse[4] = {0, 0, 0, 0};
    const int count = 20000;
    for (int i = 0; i < count; ++i) {
        Random random(3, static_cast<uint64_t>(i));
        const Incident drawn = sampler.sample(random), again = sampler.along(drawn.direction);
        EXPECT_NEAR(glm::length(drawn.direction), 1, 1e-5);
        // At the edge of a texel rounding may select its neighbour.
        if (again.radiance == drawn.radiance) {
            EXPECT_FLOAT_EQ(again.pdf, drawn.pdf);
        }
        mean_inverse[0] += 1 / drawn.pdf / count;
        for (int k = 0; k < 3; ++k) {
            const auto in = sample_light(lights[k], glm::vec3(.2f, .1f, 0), random);
            ASSERT_TRUE(in);
            const auto found = light_along(lights[k], glm::vec3(.2f, .1f, 0), in->direction);
            if (found) {
                EXPECT_NEAR(found->pdf / in->pdf, 1, 1e-3);
            }
            mean_inverse[k + 1] += 1 / in->pdf / count;
        }
    }
    // The mean of 1 / density must be the solid angle that is sampled: that of five texels, and of the cap.
    double solid_angle = 0;
    for (const int row : {0, 0, 2, 3, 7})
        solid_angle += 2 * M_PI / 16 * (std::cos(row * M_PI / 8) - std::cos((row + 1) * M_PI / 8));
    EXPECT_NEAR(mean_inverse[0], solid_angle, .05 * solid_angle);
    EXPECT_NEAR(mean_inverse[3], 2 * M_PI * (1 - std::cos(.3)), 1e-4);
}

TEST(LightSampling, DarkEnvironmentIsNone) {
    const auto nothing = tracer_of({});
    const Illumination light(*nothing, {}, {}, even_sky(0));
    EXPECT_EQ(light.environment(), nullptr);
    EXPECT_EQ(lit(wide_sun(kZ, 0, 10), {kO, kZ, kZ, glm::vec3(.5f), .01f, 0}, 1).mean, 0) << "from below";
}

}  // namespace
}  // namespace lucarne::gi::tracing
