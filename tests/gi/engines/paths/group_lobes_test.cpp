#include "gi/engines/paths/group_lobes.h"

#include <cmath>

#include <glm/geometric.hpp>
#include <gtest/gtest.h>

#include "gi/lighting/lobe_albedo.h"
#include "tests/gi/engines/test_lights.h"

namespace lucarne::gi::paths {
namespace {

const glm::vec3 kUpwards(0, 0, 1);
constexpr float kWide = 36;

Reflectance glossy(float exponent) {
    return make_reflectance(scenes::material(.2f, .6f, exponent), glm::vec3(.5f));
}
glm::vec3 at_angle(float angle, float turn = 0) {
    return {std::sin(angle) * std::cos(turn), std::sin(angle) * std::sin(turn), std::cos(angle)};
}

TEST(GroupLobes, OneLampIsReflectedByTheLobe) {
    const Reflectance surface = glossy(12);
    for (const float angle : {0.0f, .6f, 1.3f}) {
        const glm::vec3 in = at_angle(angle), irradiance(3, 2, 1);
        const MeanLobe lobe(LampLobe::of(surface, kUpwards, in, irradiance), kWide);
        for (const float out : {.1f, .7f, 1.2f})
            for (const float turn : {0.0f, 2.0f, 3.1f}) {
                const glm::vec3 to = at_angle(out, turn);
                const float exact = kPi * specular_brdf(surface, kUpwards, in, to);
                const glm::vec3 found = lobe.radiosity(to);
                EXPECT_NEAR(found.x, 3 * exact, 1e-4f + 1e-3f * exact);
                EXPECT_NEAR(found.z, exact, 1e-4f + 1e-3f * exact);
            }
    }
}

TEST(GroupLobes, WhatLeavesInAllDirectionsIsTheLobesAlbedo) {
    const Reflectance surface = glossy(10);
    const LobeAlbedo albedo(10);
    for (const float angle : {0.0f, .6f, 1.2f}) {
        const MeanLobe lobe(LampLobe::of(surface, kUpwards, at_angle(angle), glm::vec3(1)), kWide);
        double sum = 0;
        constexpr int kRings = 200, kSectors = 400;
        for (int ring = 0; ring < kRings; ++ring)
            for (int sector = 0; sector < kSectors; ++sector) {
                const float height = (static_cast<float>(ring) + .5f) / kRings;
                const glm::vec3 to =
                    at_angle(std::acos(height), 2 * kPi * (static_cast<float>(sector) + .5f) / kSectors);
                sum += 2.0 * height * lobe.radiosity(to).x / (kRings * kSectors);
            }
        EXPECT_NEAR(sum, .6 * albedo.at(std::cos(angle)), .005) << angle;
    }
}

TEST(GroupLobes, LampsInSeveralDirectionsMakeAWiderLobeOfTheSameLight) {
    const Reflectance surface = glossy(20);
    LampLobe both = LampLobe::of(surface, kUpwards, at_angle(.5f), glm::vec3(1)) * .5f;
    both += LampLobe::of(surface, kUpwards, at_angle(.5f, kPi), glm::vec3(1)) * .5f;
    const MeanLobe one(LampLobe::of(surface, kUpwards, kUpwards, glm::vec3(1)), kWide), two(both, kWide);
    EXPECT_LT(two.radiosity(kUpwards).x, .6f * one.radiosity(kUpwards).x);
    EXPECT_GT(two.radiosity(at_angle(.7f)).x, 2 * one.radiosity(at_angle(.7f)).x);
}

TEST(GroupLobes, DarknessAndExtremeLobesAreNumbers) {
    EXPECT_EQ(MeanLobe().radiosity(kUpwards), glm::vec3(0.0f));
    EXPECT_EQ(
        MeanLobe(LampLobe::of(glossy(5), kUpwards, kUpwards, glm::vec3(0.0f)), kWide).radiosity(kUpwards),
        glm::vec3(0.0f));
    // Lamps from opposite sides: no direction is left.
    LampLobe none = LampLobe::of(glossy(5), kUpwards, glm::vec3(0.0f), glm::vec3(1));
    EXPECT_EQ(MeanLobe(none, kWide).radiosity(kUpwards), glm::vec3(0.0f));
    for (const float exponent : {0.0f, 1e6f}) {
        const float peak = MeanLobe(LampLobe::of(glossy(exponent), kUpwards, kUpwards, glm::vec3(1)), kWide)
                               .radiosity(kUpwards)
                               .x;
        EXPECT_TRUE(std::isfinite(peak) && peak > 0) << exponent;
        EXPECT_LE(peak, .6f * (kWide + 2) / 2 + 1e-3f);
    }
}

}  // namespace
}  // namespace lucarne::gi::paths
