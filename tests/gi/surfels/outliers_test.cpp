#include "gi/surfels/outliers.h"

#include <algorithm>
#include <cmath>

#include <gtest/gtest.h>

#include "gi/shared/surfel_code.h"
#include "io/core/random.h"

namespace lucarne::gi {
namespace {

constexpr uint32_t kUsual = 80;  // area code: 2^-10 of a face of the node's cube

PackedSurfel surfel(const glm::vec3& place, const glm::vec3& normal, uint32_t area) {
    const glm::uvec3 at(glm::clamp(place, 0.0f, 1.0f) * 65535.0f);
    PackedSurfel s{at.x | at.y << 16, at.z | area << 16, 0, 0};
    if (normal == glm::vec3(0.0f)) return s;
    s.c = encode_octahedral(normal);
    s.d = kSurfelHasNormal;
    return s;
}
bool hidden(const PackedSurfel& s) {
    return surfel_is_stray(s.b, s.d);
}

/// A wall at x = .5, 32 by 32 points, and an upright wire at x = .25 before it.
std::vector<PackedSurfel> wall_and_wire() {
    std::vector<PackedSurfel> surfels;
    Random random(1, 0);
    for (int i = 0; i < 1024; ++i) {
        const float y = (static_cast<float>(i % 32) + static_cast<float>(random.uniform())) / 32;
        const float z = (static_cast<float>(i / 32) + static_cast<float>(random.uniform())) / 32;
        surfels.push_back(surfel({.5f, y, z}, {-1, 0, 0}, kUsual));
    }
    for (int i = 0; i < 64; ++i)
        surfels.push_back(surfel({.25f, .5f, (static_cast<float>(i) + .5f) / 64}, {0, -1, 0}, kUsual + 16));
    return surfels;
}
size_t hidden_of(uint32_t strictness, std::vector<PackedSurfel> surfels) {
    choose_outliers(strictness, {}, surfels);
    return static_cast<size_t>(std::ranges::count_if(surfels, hidden));
}

TEST(Outliers, BalloonsAreHiddenAndSurfacesAreNot) {
    const auto plain = wall_and_wire();
    for (const uint32_t strictness : {0u, 1u, 2u, 3u}) EXPECT_EQ(hidden_of(strictness, plain), 0u);
    const PackedSurfel balloons[] = {
        surfel({.25f, .5f, .3f}, {1, 0, 0}, kUsual - 40),        // at the wire, across it
        surfel({.48f, .5f, .5f}, {-1, 0, 0}, kUsual - 40),       // before the wall, which is whole without it
        surfel({.3f, .45f, .6f}, glm::vec3(0.0f), kUsual - 20),  // without a normal
    };
    for (const PackedSurfel& balloon : balloons) {
        auto surfels = plain;
        surfels.push_back(balloon);
        EXPECT_EQ(hidden_of(1, surfels), 0u);
        for (const uint32_t strictness : {2u, 3u}) {
            choose_outliers(strictness, {}, surfels);
            EXPECT_TRUE(hidden(surfels.back()));
            EXPECT_EQ(std::ranges::count_if(surfels, hidden), 1);
        }
    }
}

TEST(Outliers, SparsePartOfAWallStaysAtLevelTwo) {
    std::vector<PackedSurfel> surfels = wall_and_wire();
    // The upper half of the wall is five times sparser in spacing.
    std::erase_if(surfels, [](const PackedSurfel& s) { return surfel_fractions(s.a, s.b).z > .5f; });
    for (int i = 0; i < 18; ++i)
        surfels.push_back(
            surfel({.5f, (static_cast<float>(i % 6) + .5f) / 6, .5f + (static_cast<float>(i / 6) + .5f) / 6},
                   {-1, 0, 0}, kUsual - 37));
    EXPECT_EQ(hidden_of(2, surfels), 0u);
}

TEST(Outliers, ThoseFoundAreDrawnWithTheUsualShareAtLevelZero) {
    auto surfels = wall_and_wire();
    surfels.push_back(surfel({.1f, .1f, .1f}, glm::vec3(0.0f), kStrayArea));
    const auto found = static_cast<uint32_t>(surfels.size() - 1);
    EXPECT_EQ(hidden_of(1, surfels), 1u);
    choose_outliers(0, {found}, surfels);
    EXPECT_EQ(surfels[found].b >> 16 & 255u, kUsual);
    std::vector<PackedSurfel> alone = {surfel({.1f, .1f, .1f}, glm::vec3(0.0f), kStrayArea)};
    choose_outliers(0, {0}, alone);
    EXPECT_FALSE(hidden(alone[0]));
}

TEST(Outliers, CloudsWithoutNormalsAndHostileOnesAreDefined) {
    std::vector<PackedSurfel> bare(100, surfel({.5f, .5f, .5f}, glm::vec3(0.0f), kUnknownArea));
    EXPECT_EQ(hidden_of(3, bare), 0u) << "normals say nothing";
    EXPECT_EQ(hidden_of(3, {}), 0u);
    const std::vector<PackedSurfel> pile(20000, surfel({.5f, .5f, .5f}, {1, 0, 0}, 0));
    EXPECT_EQ(hidden_of(3, pile), 0u);
    std::vector<PackedSurfel> noise;
    Random random(2, 0);
    for (int i = 0; i < 20000; ++i) {
        const auto number = [&] { return static_cast<float>(random.uniform()); };
        noise.push_back(
            surfel({number(), number(), number()}, glm::vec3(1, 0, 0), random.uniform() < .5 ? 0u : 250u));
    }
    EXPECT_LE(hidden_of(3, noise), noise.size());
}

}  // namespace
}  // namespace lucarne::gi
