#include "viewer/flythrough/flicker.h"

#include <cmath>

#include <gtest/gtest.h>

#include "gi/shared/surfel_code.h"

namespace lucarne::viewer {
namespace {

constexpr uint32_t kSide = 20;

/// Returns a frame of a wall at y = 4, seen along y from (x, 0, 0). Its light is `light(x, z)`, its albedo
/// .5.
template <class Light>
SeenFrame wall(float x, const Light& light) {
    SeenFrame frame;
    frame.camera.origin = {x, 0, 0, 0.01f};
    frame.camera.forward = {0, 1, 0, 0};
    frame.camera.right = {1, 0, 0, 0};
    frame.camera.up = {0, 0, 1, 0};
    frame.camera.width = frame.camera.height = kSide;
    const uint32_t grey = static_cast<uint32_t>(std::lround(gi::linear_to_srgb(0.5f) * 1023));
    for (uint32_t i = 0; i < kSide * kSide; ++i) {
        const float u = 2 * (static_cast<float>(i % kSide) + .5f) / kSide - 1;
        const float v = 1 - 2 * (static_cast<float>(i / kSide) + .5f) / kSide;
        gi::GBufferTexel texel{};
        texel.depth = 4;
        texel.normal = gi::encode_octahedral(glm::vec3(0, -1, 0));
        texel.albedo = grey | grey << 10 | grey << 20;
        frame.texels.push_back(texel);
        frame.radiance.push_back(glm::vec4(light(x + 4 * u, 4 * v)));
    }
    return frame;
}

float even(float, float) {
    return 1;
}
float stripes(float x, float) {
    return std::fmod(std::abs(x - .1f), 2.0f) < 1 ? 1.0f : 3.0f;
}

TEST(Flicker, LightThatStaysOnSurfacesDoesNotFlickerHoweverTheCameraMoves) {
    const Flicker still = flicker_between(wall(0, stripes), wall(0, stripes));
    EXPECT_EQ(still.change, 0);
    EXPECT_EQ(still.matched, 1);
    const Flicker moved = flicker_between(wall(0, stripes), wall(.4f, stripes));  // by one pixel
    EXPECT_LT(moved.change, 1e-6);
    EXPECT_NEAR(moved.matched, 1 - 1.0 / kSide, 1e-9);
}

TEST(Flicker, IsTheMeanRelativeChange) {
    const auto brighter = [](float x, float) { return x < 0 ? 1.0f : 3.0f; };
    // Half of the pixels from 1 to 3 over an albedo of .5: m = 3, 2 * 4 / (8 + .6).
    const Flicker flicker = flicker_between(wall(0, even), wall(0, brighter));
    EXPECT_NEAR(flicker.change, 8 / 8.6 / 2, 2e-3);
}

TEST(Flicker, OtherSurfacesAreNotMatched) {
    SeenFrame nearer = wall(0, even);
    for (gi::GBufferTexel& texel : nearer.texels) texel.depth = 3;
    EXPECT_EQ(flicker_between(wall(0, even), nearer).matched, 0);
    SeenFrame turned = wall(0, even);
    for (gi::GBufferTexel& texel : turned.texels) texel.normal = gi::encode_octahedral(glm::vec3(1, 0, 0));
    EXPECT_EQ(flicker_between(wall(0, even), turned).matched, 0);
    EXPECT_EQ(flicker_between(wall(100, even), wall(0, even)).matched, 0);
    SeenFrame nothing = wall(0, even);
    for (gi::GBufferTexel& texel : nothing.texels) texel.depth = 0;
    EXPECT_EQ(flicker_between(nothing, wall(0, even)).matched, 0);
    EXPECT_EQ(flicker_between(wall(0, even), nothing).matched, 0);
}

TEST(Flicker, AnotherLocalOriginIsTheSamePlace) {
    SeenFrame now = wall(-255.6f, [](float x, float z) { return stripes(x + 256, z); });
    now.local_origin = {256, 0, 0};
    const Flicker flicker = flicker_between(wall(0, stripes), now);
    EXPECT_LT(flicker.change, 1e-6);
    EXPECT_GT(flicker.matched, .9);
}

}  // namespace
}  // namespace lucarne::viewer
