#include "gi/post/tone_map.h"

#include <cmath>
#include <limits>

#include <glm/vec4.hpp>
#include <gtest/gtest.h>

#include "gi/shared/luminance.h"
#include "gi/shared/tone_curve.h"
#include "tests/gi/on_device.h"

namespace lucarne::gi {
namespace {

class ToneMapTest : public OnDevice {
 protected:
    Buffer radiance(const std::vector<glm::vec4>& values) {
        auto made = device->buffer(values.size() * sizeof(glm::vec4), "radiance");
        EXPECT_TRUE(made);
        made->upload_all(values);
        return std::move(*made);
    }
    std::vector<uint32_t> map(const std::vector<glm::vec4>& values, ToneMap curve, const Exposure& exposure) {
        Buffer picture;
        const auto pixels = static_cast<uint32_t>(values.size());
        EXPECT_TRUE(tone_map(*device, radiance(values), pixels, curve, exposure, picture));
        return picture.download_all<uint32_t>(values.size());
    }
};

uint32_t srgb8(double linear) {
    const double v = linear <= 0.0031308 ? linear * 12.92 : 1.055 * std::pow(linear, 1 / 2.4) - 0.055;
    return static_cast<uint32_t>(std::lround(std::min(v, 1.0) * 255));
}

TEST_F(ToneMapTest, NoCurveCodesLinearLightAsSrgb) {
    const auto picture = map({{0.5f, 0.2f, 0.002f, 0}, {0, 1, 3, 0}}, ToneMap::none, {0});
    EXPECT_EQ(picture[0], srgb8(0.5) | srgb8(0.2) << 8 | srgb8(0.002) << 16 | 255u << 24);
    EXPECT_EQ(picture[1], 0xffffff00u);
}

TEST_F(ToneMapTest, OneStopDoublesTheLight) {
    EXPECT_EQ(map({{0.1f, 0.2f, 0.3f, 0}}, ToneMap::none, {1}),
              map({{0.2f, 0.4f, 0.6f, 0}}, ToneMap::none, {0}));
}

TEST_F(ToneMapTest, ReinhardHalvesAWhiteOfLuminanceOne) {
    EXPECT_EQ(map({{1, 1, 1, 0}}, ToneMap::reinhard, {0})[0] & 255u, srgb8(0.5));
}

TEST_F(ToneMapTest, FilmicFollowsThePublishedFit) {
    const double x = 0.18, y = x * (2.51 * x + 0.03) / (x * (2.43 * x + 0.59) + 0.14);
    EXPECT_EQ(map({{0.18f, 0.18f, 0.18f, 0}}, ToneMap::filmic, {0})[0] & 255u, srgb8(y));
}

TEST_F(ToneMapTest, CurvesRiseFromBlackToWhite) {
    std::vector<glm::vec4> ramp;
    for (int i = 0; i < 400; ++i)
        ramp.emplace_back(glm::vec4(i ? std::exp2(static_cast<float>(i) / 16 - 12) : 0.0f));
    for (const ToneMap curve : {ToneMap::filmic, ToneMap::reinhard, ToneMap::none}) {
        const auto picture = map(ramp, curve, {0});
        EXPECT_EQ(picture[0], 0xff000000u);
        EXPECT_GE(picture.back() & 255u, 250u);
        for (size_t i = 1; i < picture.size(); ++i) EXPECT_GE(picture[i] & 255u, picture[i - 1] & 255u) << i;
    }
}

TEST_F(ToneMapTest, CompressedHighlightsRiseSlowlyAndKeepTheirHue) {
    const glm::vec3 dark(0.3f, 0.1f, 0.2f), bright = 40.0f * dark;
    EXPECT_EQ(compress_highlights(dark, 5), dark) << "below the knee";
    EXPECT_EQ(compress_highlights(bright, 0), bright);
    const glm::vec3 found = compress_highlights(bright, 5);
    EXPECT_LT(found.x, 2);
    EXPECT_NEAR(found.y / found.x, dark.y / dark.x, 1e-6);
    float before = 0;
    for (float x = 0; x < 100; x += 0.01f) {
        const float now = compress_highlights(glm::vec3(x), 5).x;
        EXPECT_GE(now, before);
        EXPECT_LE(now - before, 0.0101f) << "no step at the knee";
        before = now;
    }
}

TEST_F(ToneMapTest, WhiteBalanceMakesTheWhiteNeutralAndKeepsItsLuminance) {
    const glm::dvec3 white(1.6, .9, .3);
    const glm::vec3 light = 0.2f * glm::vec3(white);
    const auto picture = map({glm::vec4(light, 0)}, ToneMap::none, {0, 0, white_balance(white)});
    const uint32_t grey = srgb8(luminance(glm::dvec3(light)));
    EXPECT_EQ(picture[0], grey | grey << 8 | grey << 16 | 255u << 24);
    EXPECT_EQ(white_balance(glm::dvec3(1)), glm::vec3(1));
    EXPECT_EQ(white_balance(3.0 * white), white_balance(white));
}

TEST_F(ToneMapTest, WhatIsNoNumberBecomesBlackAndInfinityWhite) {
    constexpr float kNone = std::numeric_limits<float>::quiet_NaN(),
                    kInfinite = std::numeric_limits<float>::infinity();
    for (const ToneMap curve : {ToneMap::filmic, ToneMap::none}) {
        const auto picture = map({glm::vec4(kNone), glm::vec4(-1.0f), glm::vec4(kInfinite)}, curve, {0});
        EXPECT_EQ(picture[0], 0xff000000u);
        EXPECT_EQ(picture[1], 0xff000000u);
        EXPECT_EQ(picture[2], 0xffffffffu);
    }
}

TEST_F(ToneMapTest, TheHostAgreesWithTheDevice) {
    std::vector<glm::vec4> values = {{0, 0, 0, 0}, {-1, 0.5f, 1e9f, 0}};
    for (int i = 0; i < 300; ++i) {
        const float level = std::exp2(0.05f * static_cast<float>(i) - 10);
        values.emplace_back(level, 0.5f * level, 2 * level, 0);
    }
    for (const ToneMap curve : {ToneMap::filmic, ToneMap::reinhard, ToneMap::none}) {
        const auto device_picture = map(values, curve, {1, 0.3f});
        const auto host_picture = tone_map(values, curve, {1, 0.3f});
        for (size_t i = 0; i < values.size(); ++i)
            for (int c = 0; c < 3; ++c)
                EXPECT_NEAR(device_picture[i] >> (8 * c) & 255u, srgb8(host_picture[i][c]), 1) << i;
    }
}

}  // namespace
}  // namespace lucarne::gi
