#include "gi/engines/environment/caches.h"

#include <algorithm>
#include <cmath>
#include <numeric>
#include <vector>

#include <gtest/gtest.h>

#include "io/core/random.h"
#include "tests/gi/engines/analytic_frame.h"

namespace lucarne::gi::environment {
namespace {

LightByNormal even_light(float radiance) {
    return {{glm::vec3(radiance)}};
}

Cache cache_at(const glm::vec3& position, float radiance, float reach = 0.5f) {
    return {position, {0, 0, 1}, reach, even_light(radiance)};
}

SurfacePoint point_at(const glm::vec3& position, const glm::vec3& normal = {0, 0, 1}) {
    return {.position = position, .normal = normal, .radius = 0.001f};
}

const CameraView kCamera = scenes::look({0, 0, 5}, {0, 0, 0}, 0.5f, 64);

std::optional<glm::vec3> light_at(std::span<const Cache> caches, const SurfacePoint& at) {
    float depth = 0;
    const glm::vec2 pixel = view_place(kCamera, at.position, depth);
    std::vector<CacheTiles::Counting> room;
    const auto found = CacheTiles(kCamera, caches).light_at(at, pixel, room);
    if (!found) return std::nullopt;
    return found->on(at.normal);
}

TEST(Caches, LightBetweenEqualCachesIsTheirs) {
    std::vector<Cache> caches;
    for (int i = -5; i <= 5; ++i)
        for (int j = -5; j <= 5; ++j) caches.push_back(cache_at(0.3f * glm::vec3(i, j, 0), 2));
    for (float x = -1; x < 1; x += 0.13f) {
        const auto found = light_at(caches, point_at({x, 0.5f * x, 0}));
        ASSERT_TRUE(found) << x;
        EXPECT_NEAR(found->y, 2, 1e-5);
    }
}

TEST(Caches, LightGoesOverFromOneToTheNextWithoutSteps) {
    const std::vector<Cache> caches = {cache_at({0, 0, 0}, 1), cache_at({0.4f, 0, 0}, 3)};
    float last = light_at(caches, point_at({0, 0, 0}))->x;
    for (float x = 0; x < 0.4f; x += 0.01f) {
        const float now = light_at(caches, point_at({x, 0, 0}))->x;
        EXPECT_GE(now, last - 1e-5f);
        EXPECT_LT(now - last, 0.2f) << x;
        last = now;
    }
}

TEST(Caches, LightAtTheEndOfASlopeIsNotThatOfItsMiddle) {
    for (const float metre : {1e-9f, 1.0f, 1e9f}) {
        std::vector<Cache> caches;
        for (int i = 0; i <= 5; ++i)
            for (int j = -5; j <= 5; ++j)
                caches.push_back(cache_at(0.1f * metre * glm::vec3(i, j, 0), 2 - 0.2f * static_cast<float>(i),
                                          0.5f * metre));
        for (const glm::vec3& normal : {glm::vec3(0, 0, 1), glm::normalize(glm::vec3(0.1f, 0.2f, 1))}) {
            const SurfacePoint at{.position = glm::vec3(0), .normal = normal};
            std::vector<CacheTiles::Counting> room;
            const auto found = CacheTiles(kCamera, caches).light_at(at, {32, 32}, room);
            ASSERT_TRUE(found) << metre;
            EXPECT_NEAR(found->on(normal).x, 2, 0.05) << metre << ": the mean is 1.7";
        }
    }
}

TEST(Caches, WhatIsFarOrTurnedAwayOrInFrontDoesNotCount) {
    const std::vector<Cache> caches = {cache_at({0, 0, 0}, 1)};
    EXPECT_TRUE(light_at(caches, point_at({0.1f, 0, 0})));
    EXPECT_FALSE(light_at(caches, point_at({0.6f, 0, 0})));
    EXPECT_FALSE(light_at(caches, point_at({0.1f, 0, 0}, {0, 0, -1})));
    EXPECT_FALSE(light_at(caches, point_at({0.1f, 0, 0}, {1, 0, 0})));
    EXPECT_FALSE(light_at(caches, point_at({0, 0, -0.1f})));  // Ward's third factor
    EXPECT_FALSE(light_at(caches, point_at({0, 0, 0.2f})));
}

/// Caches of a square, which have the light that `light` returns for their row and column.
template <class Light>
std::vector<Cache> square_of_caches(const Light& light) {
    std::vector<Cache> caches;
    for (int i = -5; i <= 5; ++i)
        for (int j = -5; j <= 5; ++j) caches.push_back(cache_at(0.3f * glm::vec3(i, j, 0), light(i, j)));
    return caches;
}

/// Returns the largest distance of their light from 2, beyond the margin of the square.
float most_off(const std::vector<Cache>& caches) {
    float most = 0;
    for (const Cache& cache : caches)
        if (std::max(std::abs(cache.position.x), std::abs(cache.position.y)) < 1)
            most = std::max(most, std::abs(cache.light.on(cache.normal).x - 2));
    return most;
}

TEST(Caches, SmoothingKeepsEvenLightAndSlopesAndEvensNoiseTheMoreTheFartherItIsShared) {
    const auto board = [](int i, int j) { return (i + j) % 2 == 0 ? 1.0f : 3.0f; };
    Random random(1);
    const auto noise = [&](int, int) { return 1 + 2 * static_cast<float>(random.uniform()); };
    const auto noisy = square_of_caches(noise);
    std::vector<float> off;
    for (const float reach : {0.5f, 1.0f, 2.0f}) {
        auto even = square_of_caches([](int, int) { return 2.0f; });
        const std::vector<float> reaches(even.size(), reach);
        smooth(kCamera, even, reaches);
        EXPECT_LT(most_off(even), 1e-5f) << reach;
        auto alternating = square_of_caches(board);
        smooth(kCamera, alternating, reaches);
        EXPECT_LT(most_off(alternating), 0.8f) << reach;
        auto evened = noisy;
        smooth(kCamera, evened, reaches);
        off.push_back(most_off(evened));
        auto slope = square_of_caches([](int i, int) { return 2 + 0.1f * static_cast<float>(i); });
        const auto before = slope;
        smooth(kCamera, slope, std::vector<float>(slope.size(), std::min(reach, 1.0f)));
        for (size_t n = 0; n < slope.size(); ++n) {
            const bool margin = std::max(std::abs(slope[n].position.x), std::abs(slope[n].position.y)) > 0.5f;
            EXPECT_NEAR(slope[n].light.on(slope[n].normal).x, before[n].light.on(before[n].normal).x,
                        margin ? 0.025f : 1e-4f);
        }
    }
    EXPECT_LT(off[1], 0.7f * off[0]);
    EXPECT_LT(off[2], 0.7f * off[1]);
}

TEST(Caches, WhatSharesLittleGetsTheLightOfOthersAndKeepsItsOwnForItself) {
    const glm::vec3 x(0.4f, 0, 0), y(0, 0.4f, 0);
    std::vector<Cache> caches = {cache_at({0, 0, 0}, 3), cache_at(x, 1), cache_at(-x, 1), cache_at(y, 1),
                                 cache_at(-y, 1)};
    smooth(kCamera, caches, std::vector<float>{0.1f, 1.0f, 1.0f, 1.0f, 1.0f});
    EXPECT_LT(caches[0].light.on(caches[0].normal).x, 2.0f);
    EXPECT_NEAR(caches[1].light.on(caches[1].normal).x, 1, 1e-5);
}

TEST(Caches, LightFollowsTheNormal) {
    std::vector<Cache> caches = {cache_at({0, 0, 0}, 1)};
    caches[0].light.terms = {glm::vec3(0.0f), glm::vec3(0.3f), glm::vec3(0.0f), glm::vec3(1.0f)};
    const float toward = light_at(caches, point_at({0, 0, 0}, glm::normalize(glm::vec3(0.2f, 0, 1))))->x;
    const float away = light_at(caches, point_at({0, 0, 0}, glm::normalize(glm::vec3(-0.2f, 0, 1))))->x;
    EXPECT_GT(toward, 1.05f * away);
}

TEST(Caches, PixelsWithoutCachesAreReturnedAndKeepTheirLight) {
    std::vector<SurfacePoint> surfaces(64 * 64, point_at({0, 0, 0}));
    for (size_t i = 0; i < surfaces.size() / 2; ++i) surfaces[i].position.x = 2;
    std::vector<uint32_t> pixels(surfaces.size());
    std::iota(pixels.begin(), pixels.end(), 0u);
    std::vector<glm::vec4> light(surfaces.size(), glm::vec4(9));
    const auto lonely =
        interpolate(kCamera, surfaces, pixels, std::vector{cache_at({0, 0, 0}, 1, 3.0f)}, light);
    EXPECT_TRUE(lonely.empty());
    const auto all = interpolate(kCamera, surfaces, pixels, {}, light);
    EXPECT_EQ(all.size(), surfaces.size());
    EXPECT_NEAR(light[5].x, 1, 1e-5);
}

}  // namespace
}  // namespace lucarne::gi::environment
