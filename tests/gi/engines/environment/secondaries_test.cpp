#include "gi/engines/environment/secondaries.h"

#include <algorithm>

#include <gtest/gtest.h>

#include "gi/engines/environment/primaries.h"
#include "gi/gather/gather_point.h"
#include "gi/shared/surfel.h"
#include "tests/gi/engines/analytic_frame.h"
#include "tests/gi/tree/flat_scenes.h"

namespace lucarne::gi::environment {
namespace {

bool never_fine(size_t) {
    return false;
}

std::vector<uint32_t> leaf_sides(const SurfelTree& tree, uint32_t back) {
    std::vector<uint32_t> sides;
    for (uint32_t slot = 0; slot < tree.surfels.size(); ++slot)
        if (tree.surfels[slot] != kNoSurfel) sides.push_back(2 * slot + back);
    return sides;
}

TEST(Secondaries, WhatHasOnlyKnownChildrenDoesNotGather) {
    const auto surfels = flat::square(16, 1);
    const SurfelTree tree = build_tree(surfels);
    std::vector<uint32_t> seen = leaf_sides(tree, 0);
    const size_t leaves = seen.size();
    // All sides that have children, too.
    for (uint32_t slot = 0; slot < tree.surfels.size(); ++slot)
        if (tree.nodes[slot / 8].child[slot % 8] >= 0) seen.push_back(2 * slot);
    Secondaries secondaries;
    secondaries.choose(tree, seen, never_fine);
    EXPECT_EQ(secondaries.seen(), seen.size());
    EXPECT_EQ(secondaries.sides().size(), leaves);
}

TEST(Secondaries, PartsOfWhatIsFineShareItsLight) {
    const auto surfels = flat::square(16, 1);
    const SurfelTree tree = build_tree(surfels);
    const auto leaves = leaf_sides(tree, 0);
    const auto fine = [&](size_t slot) { return tree.nodes[slot / 8].bound[slot % 8] < 0.3f; };
    Secondaries secondaries;
    secondaries.choose(tree, std::vector{leaves.front(), leaves[1], kSeesSky, kSeesNothing}, fine);
    EXPECT_EQ(secondaries.seen(), 2u);
    ASSERT_LE(secondaries.sides().size(), 2u);
    for (const uint32_t side : secondaries.sides()) {
        EXPECT_GE(tree.nodes[side / 16].child[side / 2 % 8], 0);
        EXPECT_TRUE(fine(side / 2));
    }
    const std::vector<glm::vec3> known(secondaries.sides().size(), glm::vec3(3, 2, 1));
    EXPECT_EQ(secondaries.propagate(tree, known)[leaves.front()], glm::vec3(3, 2, 1));
}

// As a pipe below a ceiling, whose upper side is dark while that of the ceiling is lit by the sky.
TEST(Secondaries, SheetsAboveEachOtherDoNotShareLight) {
    constexpr float kGap = 0.15f, kAllowed = 0.6f;
    auto surfels = flat::square(64, 1);
    for (FlatSurfel s : flat::square(64, 1)) {
        s.z = kGap;
        surfels.push_back(s);
    }
    const SurfelTree tree = build_tree(surfels);
    const CameraView camera = scenes::look({.5f, .5f, 30}, {.5f, .5f, 0}, 0.5f, 256);
    const float spacing = kAllowed / pixel_height(camera, 30);
    Secondaries secondaries;
    secondaries.choose(tree, leaf_sides(tree, 0),
                       [&](size_t slot) { return shares_light(tree, slot, camera, spacing); });
    EXPECT_LT(secondaries.sides().size(), surfels.size() / 8);
    std::vector<glm::vec3> known;
    for (const uint32_t side : secondaries.sides())
        known.emplace_back(place_of(tree, surfels, side).position.z > kGap / 2 ? 1.0f : 0.0f);
    const auto light = secondaries.propagate(tree, known);
    for (const uint32_t side : leaf_sides(tree, 0))
        ASSERT_EQ(light[side].x, surfels[tree.surfels[side / 2]].z > kGap / 2 ? 1 : 0);
}

TEST(Secondaries, EvenLightStaysEvenWhereverItIsPropagated) {
    const auto surfels = flat::noisy_room(4000);
    const SurfelTree tree = build_tree(surfels);
    Secondaries secondaries;
    secondaries.choose_all(tree);
    EXPECT_EQ(secondaries.sides().size(), 8000u);
    const std::vector<glm::vec3> known(secondaries.sides().size(), glm::vec3(0.7f));
    const auto light = secondaries.propagate(tree, known);
    for (size_t slot = 0; slot < tree.surfels.size(); ++slot)
        if (tree.nodes[slot / 8].child[slot % 8] != kNoChild) {
            EXPECT_NEAR(light[2 * slot].x, 0.7f, 1e-4f);
            EXPECT_NEAR(light[2 * slot + 1].x, 0.7f, 1e-4f);
        }
}

TEST(Secondaries, SidesThatNothingIsKnownOfHaveTheLightAboutThem) {
    const auto surfels = flat::square(32, 1);
    const SurfelTree tree = build_tree(surfels);
    const auto leaves = leaf_sides(tree, 0);
    Secondaries secondaries;
    secondaries.choose(tree, std::vector{leaves[5]}, never_fine);
    ASSERT_EQ(secondaries.sides().size(), 1u);
    const auto light = secondaries.propagate(tree, std::vector{glm::vec3(1)});
    size_t lit = 0;  // what has no ancestor in common with the known side stays dark
    for (const uint32_t side : leaves) lit += light[side] == glm::vec3(1);
    EXPECT_GE(lit, leaves.size() / 16);
    for (const uint32_t side : leaf_sides(tree, 1)) EXPECT_EQ(light[side], glm::vec3(0));
}

TEST(Secondaries, EmptyTreeHasNone) {
    Secondaries secondaries;
    secondaries.choose({}, {}, never_fine);
    EXPECT_TRUE(secondaries.sides().empty());
    EXPECT_TRUE(secondaries.propagate({}, {}).empty());
}

/// Surface points of a floor that fills the picture of a camera above it.
std::vector<SurfacePoint> floor_points(const CameraView& camera) {
    std::vector<SurfacePoint> points;
    for (uint32_t y = 0; y < camera.height; ++y)
        for (uint32_t x = 0; x < camera.width; ++x) {
            const glm::vec2 at(static_cast<float>(x) + .5f, static_cast<float>(y) + .5f);
            const glm::vec3 ray = view_ray(camera, at);
            const float depth = -camera.origin.z / ray.z;
            points.push_back(
                {.position = view_point(camera, at, depth), .normal = {0, 0, 1}, .radius = 0.01f});
        }
    return points;
}

TEST(PrimaryPlaces, AreNoCloserThanTheirSpacingAndLeaveNoGap) {
    const auto surfels = flat::square(256, 4.0f);
    const SurfelTree tree = build_tree(surfels);
    const CameraView camera = scenes::look({2, 2, 3}, {2, 2, 0}, 0.5f, 256);
    const auto visible = floor_points(camera);
    for (const float spacing : {8.0f, 16.0f, 32.0f}) {
        const auto places = primary_places(tree, surfels, camera, visible, spacing, 65536);
        std::vector<uint32_t> sides;
        for (const SidePlace& place : places) {
            EXPECT_FLOAT_EQ(place.normal.z, 1);
            sides.push_back(place.side);
        }
        std::ranges::sort(sides);
        EXPECT_EQ(std::ranges::adjacent_find(sides), sides.end());
        const float pixel = pixel_height(camera, 3);
        for (const SurfacePoint& point : visible) {
            float least = 1e9f;
            for (const SidePlace& place : places)
                least = std::min(least, glm::distance(place.position, point.position));
            ASSERT_LT(least, 2 * spacing * pixel) << spacing;
        }
        EXPECT_LT(places.size(), 4 * 256 * 256 / (spacing * spacing)) << spacing;
    }
}

TEST(PrimaryPlaces, AreNoMoreThanAllowed) {
    const auto surfels = flat::square(256, 4.0f);
    const SurfelTree tree = build_tree(surfels);
    const CameraView camera = scenes::look({2, 2, 3}, {2, 2, 0}, 0.5f, 256);
    EXPECT_LE(primary_places(tree, surfels, camera, floor_points(camera), 2, 100).size(), 100u);
    EXPECT_TRUE(primary_places({}, {}, camera, floor_points(camera), 8, 100).empty());
}

TEST(PrimaryPlaces, HiddenNodesHaveNone) {
    auto surfels = flat::square(64, 4.0f);
    for (FlatSurfel s : flat::square(64, 4.0f)) {
        s.z = -1;
        surfels.push_back(s);
    }
    const CameraView camera = scenes::look({2, 2, 3}, {2, 2, 0}, 0.5f, 128);
    for (const SidePlace& place :
         primary_places(build_tree(surfels), surfels, camera, floor_points(camera), 8, 65536))
        EXPECT_NEAR(place.position.z, 0, 1e-3f);
}

}  // namespace
}  // namespace lucarne::gi::environment
