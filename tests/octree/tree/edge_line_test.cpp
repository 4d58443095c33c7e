#include "octree/tree/edge_line.h"

#include <cmath>
#include <limits>
#include <numbers>

#include <glm/geometric.hpp>
#include <gtest/gtest.h>

#include "io/core/random.h"

namespace lucarne::octree {
namespace {

glm::vec3 some_unit(Random& random) {
    const double z = 2 * random.uniform() - 1, phi = 2 * std::numbers::pi * random.uniform();
    const double r = std::sqrt(1 - z * z);
    return {r * std::cos(phi), r * std::sin(phi), z};
}

/// A unit vector at right angles to a normal.
glm::vec3 some_tangent(Random& random, const glm::vec3& normal) {
    glm::vec3 t(0.0f);
    while (glm::length(t) < 0.1f) t = glm::cross(normal, some_unit(random));
    return glm::normalize(t);
}

double degrees_apart(const glm::vec3& a, const glm::vec3& b) {
    return std::acos(std::min(1.0f, glm::dot(a, b))) * 180 / std::numbers::pi;
}

TEST(EdgeLine, DirectionsAreKeptToADegreeAndDistancesToA128thOfTheSpacing) {
    Random random(3);
    double worst = 0;
    for (int i = 0; i < 100'000; ++i) {
        const glm::vec3 normal = some_unit(random);
        const EdgeLine line{some_tangent(random, normal),
                            1.0f / 64 + (kFarthestEdge - 1.0f / 64) * static_cast<float>(random.uniform())};
        const EdgeCode code = encode_edge(normal, line);
        EXPECT_EQ(encode_edge(-normal, line), code) << "whichever side of the surface is seen";
        const auto found = decode_edge(normal, code);
        ASSERT_TRUE(found);
        worst = std::max(worst, degrees_apart(found->toward, line.toward));
        EXPECT_NEAR(found->distance, line.distance, 1.0f / 128 + 1e-6f);
    }
    std::printf("largest error of a line's direction: %.2f degrees\n", worst);
    EXPECT_LT(worst, 1.6);
}

TEST(EdgeLine, LinesAlongTheAxesAreExact) {
    for (int n = 0; n < 3; ++n)
        for (int t = 0; t < 6; ++t) {
            if (t / 2 == n) continue;
            glm::vec3 normal(0.0f), toward(0.0f);
            normal[n] = 1;
            toward[t / 2] = t % 2 ? 1.0f : -1.0f;
            const auto found = decode_edge(normal, encode_edge(normal, {toward, 0.5f}));
            ASSERT_TRUE(found);
            EXPECT_EQ(found->toward, toward);
            EXPECT_EQ(found->distance, 0.5f);
        }
}

TEST(EdgeLine, AnyTwoBytesAreALineInThePlaneOrNone) {
    Random random(4);
    for (uint32_t word = 0; word < 0x10000; ++word) {
        const EdgeCode code = {static_cast<uint8_t>(word), static_cast<uint8_t>(word >> 8)};
        const glm::vec3 normal = some_unit(random);
        const auto line = decode_edge(normal, code);
        ASSERT_EQ(line.has_value(), code[1] != 0);
        if (!line) continue;
        ASSERT_NEAR(glm::length(line->toward), 1, 1e-5);
        ASSERT_NEAR(glm::dot(line->toward, normal), 0, 1e-5);
        ASSERT_TRUE(line->distance > 0 && line->distance <= kFarthestEdge);
    }
    EXPECT_FALSE(decode_edge(glm::vec3(0.0f), {1, 1})) << "without a normal there is no plane";
}

TEST(EdgeLine, WhatIsNoLineHasNoCode) {
    const float none = std::numeric_limits<float>::quiet_NaN();
    const glm::vec3 up(0, 0, 1), along(1, 0, 0);
    EXPECT_EQ(encode_edge(up, {along, kFarthestEdge * 1.01f}), kNoEdge);
    EXPECT_EQ(encode_edge(up, {up, 1}), kNoEdge) << "at right angles to the plane";
    EXPECT_EQ(encode_edge(up, {along, none}), kNoEdge);
    EXPECT_EQ(encode_edge(up, {glm::vec3(none), 1}), kNoEdge);
    EXPECT_EQ(encode_edge(up, {glm::vec3(0.0f), 1}), kNoEdge);
    EXPECT_NE(encode_edge(up, {along, 0}), kNoEdge) << "a line through the point";
}

TEST(EdgeLine, StaysInPlaceWhenItsNormalAndItsAreaAreRounded) {
    Random random(5);
    for (int i = 0; i < 10'000; ++i) {
        const glm::vec3 normal = some_unit(random), axis = some_tangent(random, normal);
        const glm::vec3 turned = glm::normalize(normal + 0.035f * axis);  // 2 degrees
        const EdgeLine line{some_tangent(random, normal), 0.9f};
        const EdgeCode code = encode_edge(normal, line);
        const auto found = decode_edge(turned, rebased_edge(code, {normal, 1}, {turned, 4}));
        ASSERT_TRUE(found);
        EXPECT_LT(degrees_apart(found->toward, line.toward), 5);
        EXPECT_NEAR(found->distance, 0.45f, 0.02f) << "half as many roots of an area four times as large";
        EXPECT_EQ(rebased_edge(code, {normal, 1}, {-normal, 1}), code);
        EXPECT_EQ(rebased_edge(code, {normal, 1}, {axis, 1}), kNoEdge) << "another surface";
        EXPECT_EQ(rebased_edge(code, {normal, 0}, {normal, 1}), kNoEdge);
        EXPECT_EQ(rebased_edge(code, {normal, 1}, {normal, 0}), kNoEdge);
        EXPECT_EQ(rebased_edge(kNoEdge, {normal, 1}, {normal, 1}), kNoEdge);
    }
}

}  // namespace
}  // namespace lucarne::octree
