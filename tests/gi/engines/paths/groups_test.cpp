#include "gi/engines/paths/groups.h"

#include <algorithm>
#include <cmath>
#include <set>

#include "tests/gi/engines/paths/paths_scenes.h"

namespace lucarne::gi::paths {
namespace {

/// Groups of a scene whose every side is hit by a ray of this width, with leaves connected as `connected`
/// says.
template <class Connected>
Groups groups_of(const std::vector<Surfel>& surfels, float width, const Connected& connected) {
    std::vector<RayHit> hits;
    for (Side side = 0; side < 2 * surfels.size(); ++side) hits.push_back({side, width});
    const Surfaces surfaces = surfaces_of(surfels);
    GroupBuilder builder(surfaces, hits, 0);
    while (builder.divide()) continue;
    for (uint32_t a = 0; a < builder.leaves(); ++a)
        for (uint32_t b = a + 1; b < builder.leaves(); ++b)
            if (connected(builder.sides_of(a).front(), builder.sides_of(b).front())) builder.connect(a, b);
    while (builder.join()) continue;
    return builder.take();
}

/// The group without a parent that holds a side.
uint32_t largest_of(const Groups& groups, Side side) {
    return groups.fitting(groups.leaf_of[side], 1e9f);
}

bool all_see_each_other(Side, Side) {
    return true;
}

TEST(Groups, HoldEverySideOnceAndTheirAreasAddUp) {
    const auto surfels = scenes::closed_box(1, 32, glm::vec3(.5f));
    const Groups groups = groups_of(surfels, .1f, all_see_each_other);
    std::vector<double> areas(groups.leaves, 0);
    for (Side side = 0; side < 2 * surfels.size(); ++side) {
        ASSERT_LT(groups.leaf_of[side], groups.leaves);
        areas[groups.leaf_of[side]] += surfels[side / 2].area;
    }
    for (uint32_t leaf = 0; leaf < groups.leaves; ++leaf)
        EXPECT_NEAR(groups.area[leaf] / areas[leaf], 1, 1e-4);
    double roots = 0;
    for (uint32_t group = 0; group < groups.count(); ++group)
        if (groups.parent[group] == kNone) roots += groups.area[group];
    EXPECT_NEAR(roots, 12, 1e-3) << "both sides of six faces";
    for (uint32_t group = groups.leaves; group < groups.count(); ++group) {
        double sum = 0;
        const uint32_t larger = group - groups.leaves;
        for (uint32_t i = groups.first[larger]; i < groups.first[larger + 1]; ++i) {
            EXPECT_EQ(groups.parent[groups.children[i]], group);
            EXPECT_LT(groups.children[i], group);
            sum += groups.area[groups.children[i]];
        }
        EXPECT_NEAR(groups.area[group] / sum, 1, 1e-4);
    }
}

TEST(Groups, CellsFitIntoTheNarrowestRay) {
    const auto surfels = scenes::closed_box(1, 64, glm::vec3(.5f));
    std::vector<RayHit> hits = {{0, .05f}, {2 * 64 * 64, .3f}};
    const Surfaces surfaces = surfaces_of(surfels);
    GroupBuilder builder(surfaces, hits, 0), bounded(surfaces, hits, .4f);
    while (builder.divide()) continue;
    while (bounded.divide()) continue;
    while (builder.join()) continue;
    const Groups groups = builder.take();
    EXPECT_LE(groups.cell[groups.leaf_of[0]], .0625f);
    const uint32_t far_from_it = groups.leaf_of[2 * (2 * 64 * 64 - 1)];
    EXPECT_GT(groups.cell[far_from_it], .2f);
    EXPECT_LT(bounded.leaves(), builder.leaves());
}

TEST(Groups, LieInPlanesThroughTheirSides) {
    const auto surfels = scenes::closed_box(1, 32, glm::vec3(.5f));
    const Groups groups = groups_of(surfels, .1f, all_see_each_other);
    const std::vector<GroupPlane> planes = groups.find_planes();
    ASSERT_EQ(planes.size(), groups.count());
    for (Side side = 0; side < 2 * surfels.size(); ++side)
        for (uint32_t group = groups.leaf_of[side]; group != kNone; group = groups.parent[group]) {
            const glm::vec3 away = surfels[side / 2].position - planes[group].centre;
            EXPECT_NEAR(glm::dot(away, planes[group].normal), 0, .01f);
            EXPECT_LT(glm::length(away), 1.5f * groups.cell[group]);
            EXPECT_GT(glm::dot(normal_of(surfels, side), planes[group].normal), .999f);
        }
}

TEST(Groups, NeverHoldBothSidesOfASheet) {
    for (const glm::vec3& across : {kX, glm::vec3(.7f, .7f, 0), glm::vec3(.58f, .58f, .58f)}) {
        std::vector<Surfel> surfels;
        const glm::vec3 normal = glm::normalize(across);
        const glm::vec3 u = glm::normalize(glm::cross(normal, glm::vec3(.1f, .2f, 1))),
                        v = glm::cross(normal, u);
        scenes::add_rectangle(surfels, kO, u, v, 40, glm::vec3(.5f));
        const Groups groups = groups_of(surfels, .1f, all_see_each_other);
        std::set<uint32_t> fronts;
        for (uint32_t i = 0; i < surfels.size(); ++i) fronts.insert(largest_of(groups, 2 * i));
        for (uint32_t i = 0; i < surfels.size(); ++i)
            EXPECT_FALSE(fronts.contains(largest_of(groups, 2 * i + 1)));
    }
}

TEST(Groups, ParallelSheetsStaySeparate) {
    // Two leaves of a wall, .1 m apart: the front of one and the front of the other face the same way.
    std::vector<Surfel> surfels;
    scenes::add_rectangle(surfels, kO, kX, kY, 64, glm::vec3(.5f));
    scenes::add_rectangle(surfels, .1f * kZ, kX, kY, 64, glm::vec3(.5f));
    const Groups groups = groups_of(surfels, .2f, all_see_each_other);
    for (uint32_t i = 0; i < 64 * 64; ++i)
        ASSERT_NE(groups.leaf_of[2 * i], groups.leaf_of[2 * (i + 64 * 64)]);
}

TEST(Groups, NeverHoldAFrontAndABack) {
    // A wall thinner than its discs are wide: the front of one sheet and the back of the other face the same
    // way.
    std::vector<Surfel> surfels;
    scenes::add_rectangle(surfels, kO, kX, kY, 64, glm::vec3(.5f));
    scenes::add_rectangle(surfels, -.01f * kZ, kY, kX, 64, glm::vec3(.5f));
    const Groups groups = groups_of(surfels, .2f, all_see_each_other);
    std::set<uint32_t> fronts;
    for (uint32_t i = 0; i < surfels.size(); ++i) fronts.insert(largest_of(groups, 2 * i));
    for (uint32_t i = 0; i < surfels.size(); ++i)
        EXPECT_FALSE(fronts.contains(largest_of(groups, 2 * i + 1)));
}

TEST(Groups, OfDifferentAirAreNotJoined) {
    const auto surfels = scenes::closed_box(1, 32, glm::vec3(.5f));
    // Inside of the box, and outside.
    const Groups groups = groups_of(surfels, .1f, [](Side a, Side b) { return a % 2 == b % 2; });
    std::set<uint32_t> inside;
    for (Side side = 0; side < 2 * surfels.size(); side += 2) inside.insert(largest_of(groups, side));
    for (Side side = 1; side < 2 * surfels.size(); side += 2)
        EXPECT_FALSE(inside.contains(largest_of(groups, side)));
    EXPECT_EQ(inside.size(), 6u) << "each face is one group";
}

TEST(Groups, EndAtAWallThatStandsOnTheirSurface) {
    std::vector<Surfel> surfels;
    scenes::add_rectangle(surfels, {-1, 0, 0}, 2.0f * kX, 2.0f * kY, 60, glm::vec3(.5f));
    const auto floor = static_cast<Side>(surfels.size());
    // Where no cell ends.
    scenes::add_rectangle(surfels, {.04f, -.5f, -.5f}, 3.0f * kY, 3.0f * kZ, 90, glm::vec3(.5f));
    const Groups groups = groups_of(surfels, .3f, all_see_each_other);
    std::set<uint32_t> before, behind;
    for (Side i = 0; i < floor; ++i)
        (surfels[i].position.x < .04f ? before : behind).insert(largest_of(groups, 2 * i));
    EXPECT_EQ(before.size(), 1u);
    EXPECT_EQ(behind.size(), 1u);
    EXPECT_NE(before, behind);
}

TEST(Groups, ReachOverTheBackOfACurvedSurface) {
    std::vector<Surfel> surfels;
    for (int x = 0; x < 120; ++x)
        for (int y = 0; y < 120; ++y) {
            const float angle = .5f * (static_cast<float>(x) / 119 - .5f);
            surfels.push_back({{4 * std::sin(angle), static_cast<float>(y) / 60, 4 * std::cos(angle)},
                               {std::sin(angle), 0, std::cos(angle)},
                               glm::vec3(.5f),
                               .02f,
                               2.0f / 7200,
                               0});
        }
    const Groups groups = groups_of(surfels, .2f, all_see_each_other);
    std::set<uint32_t> tops;
    for (Side i = 0; i < surfels.size(); ++i) tops.insert(largest_of(groups, 2 * i));
    EXPECT_EQ(tops.size(), 1u);
}

TEST(Groups, OfNothingAreNone) {
    const Surfaces none = surfaces_of({});
    GroupBuilder builder(none, {}, 0);
    while (builder.divide()) continue;
    while (builder.join()) continue;
    const Groups groups = builder.take();
    EXPECT_EQ(groups.count(), 0u);
}

}  // namespace
}  // namespace lucarne::gi::paths
