// Polygons are cut into triangles that cover them, whatever their shape.
#include "io/formats/mesh/triangulate.h"

#include <array>
#include <cmath>
#include <vector>

#include <glm/geometric.hpp>
#include <gtest/gtest.h>

#include "io/core/random.h"

namespace lucarne::io {
namespace {

using Polygon = std::vector<glm::dvec3>;
using Triangles = std::vector<std::array<uint32_t, 3>>;

/// Returns the area seen from above. A triangle that is turned over is a failure.
double covered_area(const Polygon& polygon, const Triangles& triangles) {
    double area = 0;
    for (const auto& [a, b, c] : triangles) {
        const double twice = glm::cross(polygon[b] - polygon[a], polygon[c] - polygon[a]).z;
        EXPECT_GE(twice, 0) << "turned over";
        area += twice / 2;
    }
    return area;
}

TEST(Triangulate, EarsCoverPolygonsWithHolesJoinedByABridge) {
    // A square of 4 with a square hole of 1; the bridge is walked twice.
    const Polygon polygon = {{0, 0, 7},   {2, 0, 7},    {2, 2, 7},     {0, 2, 7},    {0, 0, 7},
                             {.5, .5, 7}, {.5, 1.5, 7}, {1.5, 1.5, 7}, {1.5, .5, 7}, {.5, .5, 7}};
    Triangles triangles;
    ASSERT_TRUE(mesh::triangulate(polygon, triangles));
    EXPECT_NEAR(covered_area(polygon, triangles), 3, 1e-12);
}

TEST(Triangulate, EarsCoverAnyPolygonThatDoesNotCrossItself) {
    Random random(5);
    for (int round = 0; round < 200; ++round) {
        // Around the origin, in order of direction, at any distance.
        const int corners = 4 + static_cast<int>(random.next() % 253);
        Polygon polygon;
        double area = 0;
        for (int i = 0; i < corners; ++i) {
            const double angle = 2 * std::acos(-1.0) * i / corners, far = 0.05 + random.uniform();
            polygon.emplace_back(far * std::cos(angle), far * std::sin(angle), 0);
        }
        for (size_t i = 0; i < polygon.size(); ++i)
            area += glm::cross(polygon[i], polygon[(i + 1) % polygon.size()]).z / 2;
        Triangles triangles;
        ASSERT_TRUE(mesh::triangulate(polygon, triangles));
        ASSERT_EQ(triangles.size(), polygon.size() - 2);
        ASSERT_NEAR(covered_area(polygon, triangles), area, 1e-9);
    }
}

TEST(Triangulate, APolygonThatCrossesItselfGetsATriangleACornerStill) {
    Random random(7);
    Polygon polygon;
    for (size_t i = 0; i < mesh::kMostEarCorners; ++i)
        polygon.emplace_back(random.uniform(), random.uniform(), random.uniform());
    Triangles triangles;
    EXPECT_TRUE(mesh::triangulate(polygon, triangles));
    EXPECT_EQ(triangles.size(), polygon.size() - 2);
    std::vector<int> used(polygon.size());
    for (const auto& triangle : triangles)
        for (const uint32_t corner : triangle) ++used[corner];
    EXPECT_EQ(std::count(used.begin(), used.end(), 0), 0);
}

}  // namespace
}  // namespace lucarne::io
