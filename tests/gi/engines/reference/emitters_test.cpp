#include <cmath>
#include <vector>

#include <gtest/gtest.h>

#include "gi/shared/brdf.h"
#include "tests/gi/engines/reference/reference_scene.h"

namespace lucarne::gi::reference {
namespace {

/// A square of randomly placed discs at z = 1, normals downwards, covered `coverage` times by the discs.
std::vector<Surfel> random_square(int count, float coverage) {
    std::vector<Surfel> surfels;
    Random random(11);
    const float area = 1.0f / static_cast<float>(count), radius = std::sqrt(coverage * area / kPi);
    for (int i = 0; i < count; ++i)
        surfels.push_back({glm::vec3(random.uniform(), random.uniform(), 1 + 1e-4 * random.uniform()), -kZ,
                           glm::vec3(.5f), radius * static_cast<float>(.5 + random.uniform()), area, 1});
    return surfels;
}

MeanLuminance one_bounce(const std::vector<Surfel>& emitter, const Material& receiver, uint32_t samples) {
    const auto tracer = tracer_of(emitter);
    const Illumination light(*tracer, {receiver, material(1, 0, 1, 2)}, {}, nullptr);
    return traced(light, starts_on(kO, kX, kY, 24, .002f, glm::vec3(.5f)),
                  {.only_bounce = 1, .samples = samples});
}

TEST(Emitters, OverlapRadiusAndAreaChangeTheNoiseAndNotTheLight) {
    for (const float exponent : {0.0f, 200.0f}) {  // 0: diffuse
        const Material receiver = exponent > 0 ? material(1, .5f, exponent, 0) : material(1, 0, 1, 0);
        for (const float coverage : {.7f, 9.0f}) {
            auto emitter = random_square(2000, coverage);
            const auto sampled = one_bounce(emitter, receiver, 512);
            for (size_t i = 0; i < emitter.size(); ++i) emitter[i].area *= i % 3 ? .2f : 4;
            const auto uneven = one_bounce(emitter, receiver, 512);
            for (Surfel& s : emitter) s.area = 0;  // never drawn: only chance finds them
            const auto chance = one_bounce(emitter, receiver, 512);
            for (const auto& other : {sampled, uneven})
                EXPECT_NEAR(other.mean, chance.mean,
                            4 * std::hypot(other.standard_error, chance.standard_error))
                    << exponent << " " << coverage;
            EXPECT_LT(chance.standard_error, .006 * chance.mean);
        }
    }
}

TEST(Emitters, SamplingASmallLampFindsWhatChanceHardlyDoes) {
    std::vector<Surfel> lamp;
    scenes::add_rectangle(lamp, glm::vec3(.48f, .48f, 1), kY * .04f, kX * .04f, 8, glm::vec3(.5f), 1);
    const auto sampled = one_bounce(lamp, material(1, 0, 1, 0), 64);
    for (Surfel& s : lamp) s.area = 0;
    const auto chance = one_bounce(lamp, material(1, 0, 1, 0), 64);
    EXPECT_LT(sampled.standard_error, .1 * chance.standard_error);
    EXPECT_NEAR(sampled.mean, chance.mean, 4 * chance.standard_error);
}

TEST(Emitters, BothSidesOfAnEmittingSheetShine) {
    for (const bool flipped : {false, true}) {
        std::vector<Surfel> sheet;
        scenes::add_rectangle(sheet, kZ, flipped ? kY : kX, flipped ? kX : kY, 60, glm::vec3(.5f), 1);
        const auto mean = one_bounce(sheet, material(1, 0, 1, 0), 256);
        EXPECT_NEAR(mean.mean, .5 * 2 * .199825, .01 * .2 + 4 * mean.standard_error) << flipped;
    }
}

TEST(Emitters, SingleBouncesOfEmissionAddUpToAllOfThem) {
    auto room = scenes::closed_box(1, 30, glm::vec3(.6f));
    for (size_t i = 0; i < 40; ++i) room[i * 7].material = 1;
    const auto tracer = tracer_of(room);
    const Illumination light(*tracer, {material(1, .2f, 30, 0), material(1, 0, 1, 5)},
                             {disc_light(glm::vec3(.5f, .5f, .9f), .1f, -kZ, 8)}, nullptr);
    const auto starts = starts_on(kO, kX, kY, 16, room[0].radius, glm::vec3(.6f));
    const auto all = traced(light, starts, {.bounces = 3, .samples = 512});
    double sum = 0, variance = all.standard_error * all.standard_error;
    for (const int32_t only : {0, 1, 2, 3}) {
        const auto one = traced(light, starts, {.only_bounce = only, .samples = 512, .seed = 7});
        EXPECT_GT(one.mean, 0);
        sum += one.mean;
        variance += one.standard_error * one.standard_error;
    }
    EXPECT_NEAR(sum, all.mean, 4 * std::sqrt(variance));
    EXPECT_LT(std::sqrt(variance), .02 * sum);
}

TEST(Emitters, HalvesShareNoPathAndMakeTheWhole) {
    const auto room = scenes::closed_box(1, 30, glm::vec3(.6f));
    const auto tracer = tracer_of(room);
    const Illumination light(*tracer, {}, {disc_light(glm::vec3(.5f, .5f, .9f), .1f, -kZ, 8)}, nullptr);
    const auto starts = starts_on(kO, kX, kY, 40, room[0].radius, glm::vec3(.6f));
    const auto sums = PathTracer(light, {.bounces = 2, .samples = 64}).trace(starts);
    double differences = 0, claimed = 0;
    for (const PathSums& s : sums) {
        const float a = luminance(s.half_radiance(0)), b = luminance(s.half_radiance(1));
        EXPECT_NEAR((a + b) / 2, luminance(s.radiance()), 1e-5);
        EXPECT_EQ(s.paths[0], s.paths[1]);
        differences += (a - b) * (a - b);
        claimed += 4 * s.variance();  // each half has twice the variance of the whole
    }
    EXPECT_NEAR(differences / claimed, 1, .25);
}

TEST(Emitters, SinglePathsTakeTurnsBetweenTheHalvesFrameByFrame) {
    const auto room = scenes::closed_box(1, 10, glm::vec3(.6f));
    const auto tracer = tracer_of(room);
    const Illumination light(*tracer, {material(1, 0, 1, .4f)}, {}, nullptr);
    const Start start{glm::vec3(.5f, .5f, 0), kZ, kZ, glm::vec3(.6f), .01f, 0};
    PathSums all;
    for (uint64_t frame = 0; frame < 6; ++frame)
        all.add(PathTracer(light, {.bounces = 2, .samples = 1, .frame = frame}).trace(start, 0));
    EXPECT_EQ(all.paths[0], 3u);
    EXPECT_EQ(all.paths[1], 3u);
    EXPECT_NE(all.half_radiance(0), all.half_radiance(1));
}

}  // namespace
}  // namespace lucarne::gi::reference
