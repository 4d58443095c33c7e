// Discs of virtual scans compared with the surfaces that were scanned.
#include "tests/octree/normals/surface_truth.h"

#include <gtest/gtest.h>

namespace lucarne::octree {
namespace {

using namespace testing;

SurfaceErrors errors_of(const std::string& scene, uint64_t points) {
    const Scan scan = scan_of(scene, points);
    NormalOptions options;
    options.stations = scan.stations;
    const SurfaceErrors errors = surface_errors(scene, scan, estimate(scan.cloud, options), 50000, 3);
    std::printf("%s, %zu points: %s\n", scene.c_str(), scan.cloud.points.size(), line_of(errors).c_str());
    return errors;
}

/// Before the sides of creases were found, half of the normals there were 8 to 23 degrees off.
TEST(SurfaceTruth, NormalsAtCreasesAreThoseOfTheirOwnSide) {
    const SurfaceErrors box = errors_of("cornell", 300000);
    EXPECT_GT(box.creases, 0.02);  // or nothing was tested
    EXPECT_LT(box.crease_p50, 1.5);
    EXPECT_LT(box.p95, 3.6);  // before: 3.8
    EXPECT_LT(box.smooth_p50, 1.1);
    EXPECT_LT(box.smooth_p95, 3.5);
    EXPECT_LT(box.nearer, 0.01);
    EXPECT_LT(box.through, 0.0002);
    EXPECT_LT(box.widest_rogue, 0.05);
    const SurfaceErrors nave = errors_of("nave", 500000);
    EXPECT_GT(nave.creases, 0.1);
    EXPECT_LT(nave.crease_p50, 5);
    EXPECT_LT(nave.rogue_area, 11) << "14.9 where discs need not earn their size";
}

/// Between the edges of the blocks and the walls behind them hang groups of mixed pixels.
TEST(SurfaceTruth, MixedPixelsMakeNoDiscsInTheAir) {
    const SurfaceErrors box = errors_of("cornell", 1000000);
    EXPECT_EQ(box.rogue, 0u);
    EXPECT_LT(box.widest, 0.25);
    EXPECT_LT(box.left_out, 200u);
    EXPECT_LT(box.through, 0.0005);
}

/// Two walls that meet at a right angle along the y axis at the origin. At an outer edge they are seen from
/// outside, in a corner from inside.
Cloud walls_at_right_angles(size_t count, bool outer) {
    Random random(5);
    Cloud cloud;
    for (size_t i = 0; i < count; ++i) {
        const double across = random.uniform(), along = random.uniform(), side = outer ? 1 : -1;
        if (i % 2 == 0) {
            cloud.points.push_back({-across, along, 0});
            cloud.normals.push_back({0, 0, side});
        } else {
            cloud.points.push_back({0, along, -across});
            cloud.normals.push_back({side, 0, 0});
        }
        cloud.stations.push_back(0);
    }
    return cloud;
}

/// Returns how far the discs within two spacings of the edge reach over it: the 95th percentile, in spacings.
double reach_over_edge(bool outer, bool station_known) {
    constexpr size_t kPoints = 20000;
    const double spacing = std::sqrt(2.0 / kPoints);
    const Cloud cloud = walls_at_right_angles(kPoints, outer);
    NormalOptions options;
    const double from = outer ? 3 : -.5;
    if (station_known) options.stations = {{from, .5, from}};
    const Estimate discs = estimate(cloud, options);
    std::vector<double> reach;
    for (size_t i = 0; i < kPoints; ++i) {
        const glm::dvec3& p = cloud.points[i];
        const double distance = std::max(-p.x, -p.z), along = std::abs(p.y - .5);
        if (distance >= 2 * spacing || along >= .45) continue;
        double most = drawn_radius(discs, i);
        const auto line = decode_edge(discs.normals[i], discs.edges[i].code);
        if (line && discs.edges[i].beyond != Beyond::rises) {
            const glm::dvec3 outward = cloud.normals[i].z != 0 ? glm::dvec3(1, 0, 0) : glm::dvec3(0, 0, 1);
            const double across = glm::dot(glm::dvec3(line->toward), outward);
            if (across > .5) most = std::min(most, line->distance * std::sqrt(discs.areas[i]) / across);
        }
        reach.push_back((most - distance) / spacing);
    }
    return quantile(reach, .95);
}

/// Discs that reached over the edge of a window's reveal shaded the lamp in it: the nave's altar lost 7 % of
/// its direct light.
TEST(SurfaceTruth, DiscsHardlyReachOverOuterEdges) {
    EXPECT_LT(reach_over_edge(true, true), .7);
    // In a corner they overlap, which keeps it closed. Without a station the shape tells the two apart, or
    // nothing.
    EXPECT_GT(reach_over_edge(false, true), .8);
    EXPECT_LT(reach_over_edge(true, false), reach_over_edge(false, true) + .15);
}

}  // namespace
}  // namespace lucarne::octree
