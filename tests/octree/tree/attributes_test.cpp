#include "octree/tree/attributes.h"

#include <cmath>
#include <limits>
#include <numbers>

#include <glm/geometric.hpp>
#include <gtest/gtest.h>

#include "io/core/random.h"

namespace lucarne::octree {
namespace {

constexpr float kNan = std::numeric_limits<float>::quiet_NaN();
constexpr float kInfinity = std::numeric_limits<float>::infinity();

double degrees_between(const glm::vec3& a, const glm::vec3& b) {
    return std::atan2(glm::length(glm::cross(glm::dvec3(a), glm::dvec3(b))),
                      glm::dot(glm::dvec3(a), glm::dvec3(b))) *
           180 / std::numbers::pi;
}

TEST(Attributes, NormalsSurviveWithinSixHundredthsOfADegree) {
    Random random(1);
    double worst = 0;
    for (int i = 0; i < 200000; ++i) {
        const double z = 2 * random.uniform() - 1, phi = 2 * std::numbers::pi * random.uniform();
        const double r = std::sqrt(1 - z * z);
        const glm::vec3 n(r * std::cos(phi), r * std::sin(phi), z);
        const auto decoded = decode_normal(encode_normal(n));
        ASSERT_TRUE(decoded);
        EXPECT_NEAR(glm::length(*decoded), 1, 1e-6);
        worst = std::max(worst, degrees_between(n, *decoded));
    }
    std::printf("largest error of a coded normal: %.4f degrees\n", worst);
    EXPECT_LT(worst, 0.06);
}

TEST(Attributes, NormalsAlongTheAxesAreExact) {
    for (int axis = 0; axis < 3; ++axis)
        for (const float sign : {-1.0f, 1.0f}) {
            glm::vec3 n(0.0f);
            n[axis] = sign;
            const auto decoded = decode_normal(encode_normal(n));
            ASSERT_TRUE(decoded);
            EXPECT_LT(glm::length(*decoded - n), 1e-6f);
        }
}

TEST(Attributes, WhatIsNoDirectionIsMarked) {
    for (const auto& n :
         {glm::vec3(0.0f), glm::vec3(kNan, 0, 0), glm::vec3(0, kInfinity, 0), glm::vec3(1e30f)})
        EXPECT_EQ(encode_normal(n), kNoNormal);
    EXPECT_FALSE(decode_normal(kNoNormal));
    // Any other three bytes are some unit vector: caches may be hostile files.
    for (uint32_t word = 0; word < 0xffffff; word += 97) {
        const auto n = decode_normal(
            {static_cast<uint8_t>(word), static_cast<uint8_t>(word >> 8), static_cast<uint8_t>(word >> 16)});
        ASSERT_TRUE(n);
        ASSERT_NEAR(glm::length(*n), 1, 1e-5);
    }
}

TEST(Attributes, AreasSurviveWithinAStepOver63Octaves) {
    for (const double root : {1.0, 3.7e4})
        for (double octave = 0; octave < 63; octave += 0.37) {
            const double area = root * root * std::exp2(-octave);
            EXPECT_NEAR(decode_area(encode_area(area, root), root) / area, 1, 0.0004);
        }
}

TEST(Attributes, AreasBeyondTheRangeAreClampedOrUnknown) {
    EXPECT_EQ(encode_area(100, 1), 0);
    EXPECT_EQ(encode_area(1e-40, 1), 0xff80);
    for (const double area : {0.0, -1.0, static_cast<double>(kNan), static_cast<double>(kInfinity)})
        EXPECT_EQ(encode_area(area, 1), kNoArea);
    EXPECT_EQ(encode_area(1, 0), kNoArea);
    EXPECT_EQ(encode_area(1, static_cast<double>(kNan)), kNoArea);
    EXPECT_EQ(decode_area(kNoArea, 5), 0);
}

TEST(Attributes, RoundedNormalsAreNearAndTheAxesStay) {
    for (int step = 1; step <= kMostRounding; step *= 2) {
        double worst = 0;
        Random random(4);
        for (int i = 0; i < 20'000; ++i) {
            const glm::vec3 n = glm::normalize(
                glm::vec3(2 * random.uniform() - 1, 2 * random.uniform() - 1, 2 * random.uniform() - 1));
            const NormalCode rounded = round_normal(encode_normal(n), step);
            EXPECT_EQ(round_normal(rounded, step), rounded);
            worst = std::max(worst, degrees_between(n, *decode_normal(rounded)));
        }
        EXPECT_LT(worst, .062 * (step + 1)) << step;
        for (int axis = 0; axis < 6; ++axis) {
            glm::vec3 n(0.0f);
            n[axis / 2] = axis % 2 ? -1.0f : 1.0f;
            EXPECT_NEAR(glm::dot(n, *decode_normal(round_normal(encode_normal(n), step))), 1, 1e-6) << axis;
        }
        EXPECT_EQ(round_normal(kNoNormal, step), kNoNormal);
    }
}

TEST(Attributes, RoundedAreasAreNearAndUnknownStaysUnknown) {
    for (int step = 1; step <= kMostAreaRounding; step *= 2) {
        for (int code = 0; code <= 0xff80; ++code) {
            const uint16_t rounded = round_area(static_cast<uint16_t>(code), step);
            ASSERT_LE(std::abs(rounded - code), step / 2);
            ASSERT_EQ(rounded % step, 0);
            ASSERT_NE(rounded, kNoArea);
        }
        EXPECT_EQ(round_area(kNoArea, step), kNoArea);
    }
}

}  // namespace
}  // namespace lucarne::octree
