// Directions of the sky, with and without favoured ones.
#include "gi/lighting/sky_directions.h"

#include <cmath>
#include <limits>
#include <random>

#include <glm/geometric.hpp>
#include <gtest/gtest.h>

#include "gi/lighting/sky_grid.h"

namespace lucarne::gi {
namespace {

std::shared_ptr<const Environment> make_sky(uint32_t width, uint32_t height) {
    auto sky = std::make_shared<Environment>();
    sky->width = width, sky->height = height, sky->rotation = 0.7f;
    std::mt19937 random(4);
    std::uniform_real_distribution<float> uniform(0, 1);
    sky->texels.clear();
    for (uint32_t i = 0; i < width * height; ++i)
        sky->texels.push_back(glm::vec3(std::pow(uniform(random), 8.0f), uniform(random), 0.5f));
    return sky;
}

glm::dvec2 point_of(int i, int count) {
    return {glm::fract(i * 0.6180339887498949), (i + 0.5) / count};
}

/// The irradiance of a surface with the normal (.6, 0, .8), estimated from evenly drawn directions.
glm::dvec3 irradiance(const SkyDirections& sky) {
    constexpr int kCount = 200000;
    glm::dvec3 sum(0.0);
    for (int i = 0; i < kCount; ++i) {
        const auto [direction, flux] = sky.draw(point_of(i, kCount));
        const double cosine = std::max(0.0f, glm::dot(direction, glm::vec3(0.6f, 0, 0.8f)));
        sum += glm::dvec3(flux) * (cosine / kCount);
    }
    return sum;
}

TEST(SkyDirections, FavouringSomeKeepsTheLightOfTheWholeSky) {
    std::vector<float> importance(kSkyCells);
    std::mt19937 random(5);
    for (float& value : importance) value = random() % 3 ? 0.0f : static_cast<float>(random() % 1000);
    for (const auto& [width, height] : {std::pair{16u, 8u}, std::pair{1u, 1u}, std::pair{700u, 350u}}) {
        SkyDirections sky(make_sky(width, height));
        const glm::dvec3 whole = irradiance(sky);
        sky.favour(importance);
        const glm::dvec3 favoured = irradiance(sky);
        for (int i = 0; i < 3; ++i)
            EXPECT_NEAR(favoured[i], whole[i], 0.01 * whole[i]) << width << " texels, channel " << i;
    }
}

TEST(SkyDirections, HalfOfThemAreFavoured) {
    SkyDirections sky(make_sky(1, 1));
    std::vector<float> importance(kSkyCells, 0.0f);
    const uint32_t cell = sky_cell(glm::normalize(glm::vec3(-0.4f, 0.5f, 0.3f)));
    importance[cell] = 1e-7f;
    sky.favour(importance);
    int hits = 0;
    for (int i = 0; i < 1000; ++i) hits += sky_cell(sky.draw(point_of(i, 1000)).direction) == cell;
    EXPECT_NEAR(hits, 500, 2);
}

TEST(SkyDirections, WithoutUsableImportanceLuminanceDecides) {
    SkyDirections plain(make_sky(16, 8)), sky(make_sky(16, 8));
    std::vector<float> infinite(kSkyCells, std::numeric_limits<float>::infinity());
    std::vector<float> nothing(kSkyCells, std::numeric_limits<float>::quiet_NaN());
    const std::vector<std::vector<float>> unusable = {
        {}, {1, 2, 3}, std::vector<float>(kSkyCells, 0.0f), infinite, nothing};
    for (const auto& importance : unusable) {
        sky.favour(importance);
        for (int i = 0; i < 100; ++i) {
            const auto a = plain.draw(point_of(i, 100)), b = sky.draw(point_of(i, 100));
            EXPECT_EQ(a.direction, b.direction);
            EXPECT_EQ(a.flux, b.flux);
        }
    }
    SkyDirections dark;
    dark.favour(std::vector<float>(kSkyCells, 1.0f));
    EXPECT_TRUE(dark.dark());
}

}  // namespace
}  // namespace lucarne::gi
