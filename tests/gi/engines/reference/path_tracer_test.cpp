#include <algorithm>
#include <cmath>
#include <vector>

#include <glm/geometric.hpp>
#include <gtest/gtest.h>

#include "gi/tracing/scatter.h"
#include "io/core/parallel.h"
#include "tests/gi/engines/reference/reference_scene.h"

namespace lucarne::gi::reference {

using tracing::scatter;
namespace {

// Takes over ten CPU-seconds: an error below a per mille needs so many paths.
TEST(Reference, ClosedFurnaceAfterBounceKIsOneMinusRhoToTheKPlusOne) {
    for (const float rho : {0.5f, 0.8f}) {
        const auto surfels = scenes::closed_box(1, 40, glm::vec3(rho));
        const auto tracer = tracer_of(surfels);
        const Illumination light(*tracer, {material(1, 0, 1, 1 - rho)}, {}, nullptr);
        const auto starts = starts_on(kO, kX, kY, 32, surfels[0].radius, glm::vec3(rho));
        for (const uint32_t bounces : {0u, 1u, 2u, 4u, 8u}) {
            const auto mean = traced(light, starts, {.bounces = bounces, .samples = 256});
            const double truth = 1 - std::pow(rho, bounces + 1.0);
            EXPECT_LT(mean.standard_error, 0.0006 * truth) << rho << " " << bounces;
            EXPECT_NEAR(mean.mean, truth, std::max(0.001 * truth, 4 * mean.standard_error))
                << rho << " " << bounces;
        }
    }
}

TEST(Reference, OpenFurnaceUnderAUniformEnvironmentIsOneEverywhere) {
    // Under a uniform sky a surface by itself reflects its albedo of the sky's radiance. An open box that
    // emits what it does not reflect is as bright as the sky above it.
    const float rho = 0.6f;
    const auto floor_starts = [&](float radius) { return starts_on(kO, kX, kY, 24, radius, glm::vec3(rho)); };
    const auto nothing = tracer_of({});
    const Illumination alone(*nothing, {}, {}, even_sky(1));
    const auto open = traced(alone, floor_starts(.01f), {.bounces = 3, .samples = 256});
    EXPECT_NEAR(open.mean, rho, 1e-6 + 5 * open.standard_error);
    auto box = scenes::closed_box(1, 60, glm::vec3(rho));
    std::erase_if(box, [](const Surfel& s) { return s.normal.z < -.5f; });
    const auto tracer = tracer_of(box);
    const Illumination light(*tracer, {material(1, 0, 1, 1 - rho)}, {}, even_sky(1));
    const auto mean = traced(light, floor_starts(box[0].radius), {.bounces = 30, .samples = 512});
    EXPECT_LT(mean.standard_error, 0.001);
    EXPECT_NEAR(mean.mean, 1, 0.001 + 3 * mean.standard_error);
}

TEST(Reference, BouncesOneByOneAddUpToAllOfThem) {
    const auto surfels = scenes::closed_box(1, 30, glm::vec3(0.6f));
    const auto tracer = tracer_of(surfels);
    const std::vector<Material> materials = {material(1, 0, 1, 0.4f)};
    const auto starts = starts_on(kO, kX, kY, 8, surfels[0].radius, glm::vec3(0.6f));
    for (const int32_t only : {0, 1, 2, 6}) {
        const Illumination light(*tracer, materials, {}, nullptr);
        const PathTracer paths(light, {.bounces = 1, .only_bounce = only, .samples = 64});
        const auto mean = mean_luminance(paths.trace(starts));
        EXPECT_NEAR(mean.mean, 0.4 * std::pow(0.6, only), std::max(5 * mean.standard_error, 1e-5)) << only;
    }
}

TEST(Reference, GlossyFurnaceNeverGainsEnergy) {
    for (const float exponent : {1.0f, 10.0f, 100.0f, 1000.0f}) {
        const auto surfels = scenes::closed_box(1, 30, glm::vec3(0.4f));
        const auto tracer = tracer_of(surfels);
        const std::vector<Material> materials = {material(1, 0.4f, exponent, 0.2f)};
        const auto starts = starts_on(kO, kX, kY, 12, surfels[0].radius, glm::vec3(0.4f));
        const Illumination light(*tracer, materials, {}, nullptr);
        const PathTracer paths(light, {.bounces = 30, .samples = 64});
        const auto mean = mean_luminance(paths.trace(starts));
        EXPECT_LT(mean.mean, 1 + 4 * mean.standard_error) << exponent;
        EXPECT_GT(mean.mean, 0.5) << exponent;
    }
}

// The share of light that leaves one unit square and reaches another (Howell, A Catalog of Radiation Heat
// Transfer Configuration Factors, C-11 and C-14).
double form_factor(const std::vector<Surfel>& emitter, const std::vector<Start>& receiver) {
    const auto tracer = tracer_of(emitter);
    const std::vector<Material> materials = {material(1, 0, 1, 0), material(0, 0, 1, 1)};
    const Illumination light(*tracer, materials, {}, nullptr);
    const PathTracer paths(light, {.only_bounce = 1, .samples = 256});
    const auto mean = mean_luminance(paths.trace(receiver));
    EXPECT_LT(mean.standard_error, 0.0003);
    return mean.mean / 0.5;  // the receivers' albedo
}

TEST(Reference, ParallelSquaresExchangeTheirFormFactor) {
    for (const auto& [distance, truth] : {std::pair{1.0f, 0.199825}, std::pair{0.5f, 0.415253}}) {
        std::vector<Surfel> emitter;
        scenes::add_rectangle(emitter, kZ * distance, kY, kX, 400, glm::vec3(0.5f), 1);
        const auto receiver = starts_on(kO, kX, kY, 64, 0.002f, glm::vec3(0.5f));
        // Discs overlap the square's edge by .12 of their spacing (1/400): .15 % of its area.
        EXPECT_NEAR(form_factor(emitter, receiver), truth, 0.005 * truth) << distance;
    }
}

TEST(Reference, PerpendicularSquaresExchangeTheirFormFactor) {
    std::vector<Surfel> emitter;
    scenes::add_rectangle(emitter, kO, kY, kZ, 400, glm::vec3(0.5f), 1);
    const auto receiver = starts_on(kO, kX, kY, 64, 0.002f, glm::vec3(0.5f));
    EXPECT_NEAR(form_factor(emitter, receiver), 0.200044, 0.005 * 0.200044);
}

TEST(Reference, SpotLightFallsWithTheSquareOfDistanceAndTheCosine) {
    std::vector<Surfel> floor;
    scenes::add_rectangle(floor, kO, kX, kY, 50, glm::vec3(0.5f));
    const auto tracer = tracer_of(floor);
    const glm::vec3 place(0.9f, 0.5f, 2.0f), point(0.3f, 0.4f, 0.0f);
    const std::vector<Light> lights = {spot(place, point, 0.5f, 0.4f, 10)};
    const Illumination light(*tracer, {}, lights, nullptr);
    const PathTracer paths(light, {.bounces = 0});
    const Start start{point, kZ, kZ, glm::vec3(0.5f), floor[0].radius, 0};
    const glm::vec3 to_light = place - point;
    const float d2 = glm::dot(to_light, to_light);
    const float expected = 0.5f / kPi * 10 * (to_light.z / std::sqrt(d2)) / d2;
    EXPECT_NEAR(paths.trace(start, 0).radiance().x, expected, 1e-5f * expected);
    EXPECT_EQ(paths.trace(start, 0).variance(), 0.0f);
}

TEST(Reference, SpotLightEndsSmoothlyAtItsCone) {
    const auto tracer = tracer_of({});
    const std::vector<Light> lights = {spot(kZ, kO, std::atan(1.0f), 0.0f, 1)};
    const Illumination light(*tracer, {}, lights, nullptr);
    const PathTracer paths(light, {.bounces = 0});
    const auto at = [&](float x) {
        return paths.trace({glm::vec3(x, 0, 0), kZ, kZ, glm::vec3(0.5f), 0.01f, 0}, 0).radiance().x;
    };
    const float cosine = 1 / std::sqrt(1.25f), outer = std::sqrt(0.5f);
    const float t = (cosine - outer) / (1 - outer);
    EXPECT_NEAR(at(0.5f), 0.5f / kPi * t * t * (3 - 2 * t) * cosine / 1.25f, 1e-6f);
    EXPECT_EQ(at(1.001f), 0.0f);
    EXPECT_GT(at(0.999f), 0.0f);
}

TEST(Reference, SheetCastsAShadowFromBothItsSides) {
    for (const bool flipped : {false, true}) {
        std::vector<Surfel> sheet;
        scenes::add_rectangle(sheet, glm::vec3(-.5f, -.5f, 1), flipped ? kY : kX, flipped ? kX : kY, 40,
                              glm::vec3(0.5f));
        const auto tracer = tracer_of(sheet);
        const std::vector<Light> lights = {spot(2.0f * kZ, kO, 0.7f, 0.6f, 10)};
        const Illumination light(*tracer, {}, lights, nullptr);
        const PathTracer paths(light, {.bounces = 0});
        EXPECT_EQ(paths.trace({kO, kZ, kZ, glm::vec3(0.5f), 0.01f, 0}, 0).radiance().x, 0.0f);
        EXPECT_GT(paths.trace({1.2f * kX, kZ, kZ, glm::vec3(0.5f), 0.01f, 0}, 0).radiance().x, 0.0f);
    }
}

TEST(Reference, SealedDarkRoomIsBlackHoweverBrightTheLightOutside) {
    const auto surfels = scenes::closed_box(1, 40, glm::vec3(0.9f));
    const auto tracer = tracer_of(surfels);
    const std::vector<Light> lights = {spot(glm::vec3(.5f, .5f, 3), glm::vec3(.5f), 1.0f, 0.9f, 1e6f),
                                       spot(glm::vec3(-2, .4f, .3f), glm::vec3(.5f), 1.0f, 0.9f, 1e6f)};
    const Illumination light(*tracer, {}, lights, nullptr);
    const PathTracer paths(light, {.bounces = 4, .samples = 32});
    const auto estimates = paths.trace(starts_on(kO, kX, kY, 32, surfels[0].radius, glm::vec3(0.9f)));
    for (const PathSums& e : estimates) ASSERT_EQ(e.radiance(), kO);
}

// A wall that is lit and one that sees only the first: the light of one bounce, integrated numerically.
TEST(Reference, OneBounceFromALitWallMatchesQuadrature) {
    std::vector<Surfel> wall;
    scenes::add_rectangle(wall, kO, kY, kZ, 200, glm::vec3(0.6f));
    const auto tracer = tracer_of(wall);
    const glm::vec3 place(1.5f, .5f, .5f), receiver(0.5f, 0.4f, 0.0f);
    const std::vector<Light> lights = {spot(place, glm::vec3(0, .5f, .5f), 0.8f, 0.8f, 20)};
    const Illumination light(*tracer, {}, lights, nullptr);
    const PathTracer paths(light, {.only_bounce = 1, .samples = 200000});
    const PathSums estimate = paths.trace({receiver, kZ, kZ, glm::vec3(0.5f), 0.002f, 0}, 0);
    double irradiance = 0;
    for (const Surfel& s : wall) {
        const glm::vec3 to_light = place - s.position, to_receiver = receiver - s.position;
        const double l2 = glm::dot(to_light, to_light), r2 = glm::dot(to_receiver, to_receiver);
        const double incident = 20 * (to_light.x / std::sqrt(l2)) / l2;
        irradiance += 0.6 / kPi * incident * (to_receiver.x / std::sqrt(r2)) *
                      (-to_receiver.z / std::sqrt(r2)) / r2 * s.area;
    }
    const double truth = 0.5 / kPi * irradiance, error = std::sqrt(estimate.variance());
    EXPECT_LT(error, 0.01 * truth);
    EXPECT_NEAR(luminance(estimate.radiance()), truth, 4 * error + 0.003 * truth);
}

TEST(Reference, SamplesOfBothLobesIntegrateTheBrdf) {
    // The albedo of the mixture, by its own sampling against uniform sampling of the hemisphere.
    const Reflectance surface = make_reflectance(material(1, 0.5f, 20, 0), glm::vec3(0.3f));
    const glm::vec3 out = glm::normalize(glm::vec3(0.6f, 0.1f, 0.8f));
    double sampled = 0, uniform = 0;
    const int count = 400000;
    for (int i = 0; i < count; ++i) {
        Random random(1, static_cast<uint64_t>(i));
        if (const auto s = scatter(surface, kZ, out, random)) sampled += s->weight.x;
        const double z = random.uniform(), phi = 2 * M_PI * random.uniform(), r = std::sqrt(1 - z * z);
        uniform +=
            brdf(surface, kZ, out, glm::vec3(r * std::cos(phi), r * std::sin(phi), z)).x * z * 2 * M_PI;
    }
    EXPECT_NEAR(sampled / count, uniform / count, 0.005);
    EXPECT_LE(sampled / count, 0.8);
}

TEST(Reference, SamePicturesForAnyNumberOfThreads) {
    const auto surfels = scenes::closed_box(1, 30, glm::vec3(0.7f));
    const auto tracer = tracer_of(surfels);
    const std::vector<Light> lights = {spot(glm::vec3(.5f, .5f, .9f), glm::vec3(.5f, .5f, 0), 0.8f, 0.6f, 1)};
    const auto starts = starts_on(kO, kX, kY, 40, surfels[0].radius, glm::vec3(0.7f));
    const Illumination light(*tracer, {}, lights, nullptr);
    const PathTracer paths(light, {.bounces = 6, .samples = 8, .seed = 5});
    const auto render = [&](unsigned threads) {
        const ThreadLimit limit(threads);
        return paths.trace(starts);
    };
    const auto one = render(1), many = render(4);
    for (size_t i = 0; i < one.size(); ++i) ASSERT_EQ(one[i].radiance(), many[i].radiance()) << i;
}

TEST(Reference, AnotherSeedOrFrameGivesOtherNumbersAndTheSameMean) {
    const auto surfels = scenes::closed_box(1, 30, glm::vec3(0.5f));
    const auto tracer = tracer_of(surfels);
    const std::vector<Light> lights = {spot(glm::vec3(.5f, .5f, .9f), glm::vec3(.5f, .5f, 0), 0.8f, 0.6f, 1)};
    const auto starts = starts_on(kO, kZ, kX, 16, surfels[0].radius, glm::vec3(0.5f));
    const auto mean = [&](uint64_t seed, uint64_t frame) {
        const Illumination light(*tracer, {}, lights, nullptr);
        const PathTracer paths(light, {.bounces = 2, .samples = 64, .seed = seed, .frame = frame});
        return mean_luminance(paths.trace(starts));
    };
    const auto first = mean(1, 0), frame = mean(1, 1), seed = mean(2, 0);
    for (const auto& other : {frame, seed}) {
        EXPECT_NE(first.mean, other.mean);
        EXPECT_NEAR(first.mean, other.mean, 5 * std::hypot(first.standard_error, other.standard_error));
    }
}

TEST(Reference, StandardErrorIsThatOfRepeatedRuns) {
    const auto surfels = scenes::closed_box(1, 30, glm::vec3(0.5f));
    const auto tracer = tracer_of(surfels);
    const std::vector<Light> lights = {spot(glm::vec3(.5f, .5f, .9f), glm::vec3(.5f, .5f, 0), 0.8f, 0.6f, 1)};
    const auto starts = starts_on(kO, kZ, kX, 8, surfels[0].radius, glm::vec3(0.5f));
    double sum = 0, squares = 0, claimed = 0;
    const int runs = 200;
    for (int run = 0; run < runs; ++run) {
        const Illumination light(*tracer, {}, lights, nullptr);
        const PathTracer paths(light,
                               {.bounces = 1, .samples = 16, .seed = 3, .frame = static_cast<uint64_t>(run)});
        const auto mean = mean_luminance(paths.trace(starts));
        sum += mean.mean, squares += mean.mean * mean.mean, claimed += mean.standard_error;
    }
    const double spread = std::sqrt((squares - sum * sum / runs) / (runs - 1));
    EXPECT_NEAR(claimed / runs / spread, 1.0, 0.25);  // 5 times the error of 200 runs
}

TEST(Reference, SurfelsWithoutNormalOrSizeAreNoObstacle) {
    std::vector<Surfel> surfels;
    scenes::add_rectangle(surfels, glm::vec3(-.5f, -.5f, 1), kX, kY, 20, glm::vec3(0.5f));
    const float nan = std::nanf("");
    for (size_t i = 0; i < surfels.size(); ++i) switch (i % 4) {
            case 0:
                surfels[i].normal = kO;
                break;
            case 1:
                surfels[i].normal.x = nan;
                break;
            case 2:
                surfels[i].radius = 0;
                break;
            default:
                surfels[i].position.y = nan;
        }
    const auto tracer = tracer_of(surfels);
    EXPECT_TRUE(tracer->surfels().empty());
    EXPECT_FALSE(tracer->nearest(kO, kZ));
    EXPECT_FALSE(tracer->occluded(kO, 2.0f * kZ));
}

TEST(Reference, LightAtASurfaceOrInsideAWallLeavesNoNaN) {
    const auto surfels = scenes::closed_box(1, 20, glm::vec3(1.0f));
    const auto tracer = tracer_of(surfels);
    for (const glm::vec3& place :
         {kO, glm::vec3(.5f, .5f, 0), surfels[7].position, glm::vec3(.5f, .5f, -1e-4f)}) {
        const std::vector<Light> lights = {spot(place, place + kZ, 1.2f, 1.0f, 10)};
        const Illumination light(*tracer, {}, lights, nullptr);
        const PathTracer paths(light, {.bounces = 3, .samples = 8});
        for (const PathSums& e : paths.trace(starts_on(kO, kX, kY, 20, surfels[0].radius, glm::vec3(1.0f))))
            ASSERT_TRUE(std::isfinite(luminance(e.radiance())) && e.radiance().x >= 0);
    }
}

}  // namespace
}  // namespace lucarne::gi::reference
