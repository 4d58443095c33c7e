#include "octree/growing/quick_surface.h"

#include <cmath>
#include <numbers>

#include <glm/geometric.hpp>
#include <gtest/gtest.h>

#include "io/core/random.h"
#include "octree/normals/normals.h"

namespace lucarne::octree {
namespace {

/// Returns the summed shares of random points on a sphere of radius .5, over its surface.
double measured(size_t count, bool with_stations) {
    std::vector<glm::dvec3> points;
    Random random(5);
    for (size_t i = 0; i < count; ++i) {
        const double z = 2 * random.uniform() - 1, angle = 2 * std::numbers::pi * random.uniform(),
                     r = std::sqrt(1 - z * z);
        points.push_back(0.5 + 0.5 * glm::dvec3(r * std::cos(angle), r * std::sin(angle), z));
    }
    std::vector<std::optional<glm::dvec3>> stations(count);
    if (with_stations) stations.assign(count, glm::dvec3(0.5));
    double sum = 0;
    for (const QuickSurface& point : quick_surface(points, {glm::dvec3(0), 1}, stations))
        if (point.area != kStrayArea) sum += point.area;
    return sum / std::numbers::pi;
}

TEST(QuickSurface, SharesAddUpToTheSurfaceWithEverySearch) {
    EXPECT_NEAR(measured(50'000, false), 1, 0.1);
    EXPECT_NEAR(measured(50'000, true), 1, 0.1);
    EXPECT_NEAR(measured(1'100'000, true), 1, 0.1) << "fewer neighbours among many points";
}

}  // namespace
}  // namespace lucarne::octree
