#include "gi/gather/point_groups.h"

#include <algorithm>
#include <numeric>
#include <vector>

#include <glm/geometric.hpp>
#include <gtest/gtest.h>

#include "io/core/random.h"

namespace lucarne::gi {
namespace {

GatherPoint point_at(const glm::vec3& position, const glm::vec3& normal) {
    return {position, 0.01f, normal, 0, glm::vec3(0.0f), 0, normal, 1};
}

/// Points on the floor and on a wall of a room, in any order.
std::vector<GatherPoint> corner(size_t count) {
    std::vector<GatherPoint> points;
    Random random(3);
    for (size_t i = 0; i < count; ++i) {
        const auto x = static_cast<float>(random.uniform()), y = static_cast<float>(random.uniform());
        points.push_back(i % 2 ? point_at({x, y, 0}, {0, 0, 1}) : point_at({x, 0, y}, {0, 1, 0}));
    }
    return points;
}

TEST(PointGroups, HoldEveryPointOnce) {
    for (const size_t count : {0u, 1u, 7u, 8u, 9u, 1000u, 5000u}) {
        const PointGroups groups = group_points(corner(count), 1);
        std::vector<uint32_t> numbers = groups.order, all(count);
        std::sort(numbers.begin(), numbers.end());
        std::iota(all.begin(), all.end(), 0u);
        EXPECT_EQ(numbers, all);
        ASSERT_FALSE(groups.first.empty());
        EXPECT_EQ(groups.first.back(), count);
        for (size_t i = 0; i + 1 < groups.first.size(); ++i) {
            EXPECT_LT(groups.first[i], groups.first[i + 1]);
            const uint32_t size = groups.first[i + 1] - groups.first[i];
            EXPECT_LE(size, kGroupedPoints);
            if (i < groups.full) {
                EXPECT_GE(size, kLeastGroup);
            } else {
                EXPECT_EQ(size, 1u);
            }
        }
    }
}

TEST(PointGroups, AreNarrowAndFullWherePointsAreDense) {
    const auto points = corner(20000);
    const PointGroups groups = group_points(points, 1);
    for (size_t i = 0; i + 1 < groups.first.size(); ++i)
        for (uint32_t k = groups.first[i]; k < groups.first[i + 1]; ++k) {
            const GatherPoint &a = points[groups.order[groups.first[i]]], &b = points[groups.order[k]];
            EXPECT_EQ(a.normal, b.normal);
            EXPECT_LT(glm::distance(glm::vec3(a.position), glm::vec3(b.position)), 0.3f);
        }
    EXPECT_LT(groups.first.size(), 20000 / 6);
}

TEST(PointGroups, SmallGroupsAreTakenApart) {
    std::vector<GatherPoint> points;
    for (int place = 0; place < 20; ++place)
        for (size_t i = 0; i < (place % 2 ? kLeastGroup : kLeastGroup - 1); ++i)
            points.push_back(point_at({static_cast<float>(1 << place), 0, 0}, {0, 0, 1}));
    const PointGroups groups = group_points(points, 1);
    EXPECT_EQ(groups.full, 10u);
    EXPECT_EQ(groups.first.size(), 10 + 10 * (kLeastGroup - 1) + 1);
}

TEST(PointGroups, FarPointsStandAlone) {
    std::vector<GatherPoint> points;
    for (int i = 0; i < 64; ++i) points.push_back(point_at({10.0f * static_cast<float>(i), 0, 0}, {0, 0, 1}));
    EXPECT_EQ(group_points(points, 1).first.size(), 65u);
}

// Any order of equal points is a division, and recursion ends.
TEST(PointGroups, PointsInOnePlaceAreDivided) {
    const std::vector<GatherPoint> points(3000, point_at(glm::vec3(1.0f), {0, 0, 1}));
    EXPECT_EQ(group_points(points, 0).first.size(), 3000u / kGroupedPoints + 1);
}

}  // namespace
}  // namespace lucarne::gi
