// Stations that are found from the order of a scan's points alone.
#include "octree/stations/find_stations.h"

#include <algorithm>
#include <cmath>
#include <span>
#include <tuple>
#include <utility>
#include <vector>

#include <glm/geometric.hpp>
#include <gtest/gtest.h>

#include "io/core/random.h"
#include "io/synthetic/synthetic.h"

namespace lucarne::octree {
namespace {

struct Searched {
    std::vector<glm::dvec3> stations;  ///< true ones
    std::vector<glm::dvec3> found;
};

Searched searched(const io::SyntheticOptions& options, size_t batch = 65536) {
    Searched result;
    const auto source = io::synthetic_source(options);
    EXPECT_TRUE(source) << (source ? "" : source.error().line());
    if (!source) return result;
    for (const auto& station : (*source)->info().stations) result.stations.push_back(station.position);
    const auto reader = (*source)->open();
    EXPECT_TRUE(reader);
    if (!reader) return result;
    ScanRuns runs;
    io::PointBatch points;
    for (auto read = (*reader)->read(points, batch); read && *read > 0; read = (*reader)->read(points, batch))
        runs.add((*source)->schema(), points.bytes);
    result.found = find_stations(runs, 1);
    return result;
}

std::vector<glm::dvec3> found_in(const std::vector<glm::dvec3>& points, double unit = 1) {
    io::Schema schema;
    ScanRuns runs;
    runs.add(schema, std::as_bytes(std::span(points)));
    return find_stations(runs, unit);
}

/// Returns the largest distance between a station of one list and the nearest one of the other list.
double farthest(const std::vector<glm::dvec3>& from, const std::vector<glm::dvec3>& to) {
    double most = 0;
    for (const glm::dvec3& a : from) {
        double least = INFINITY;
        for (const glm::dvec3& b : to) least = std::min(least, glm::distance(a, b));
        most = std::max(most, least);
    }
    return most;
}

/// A room of 6 x 5 x 3 units around the origin, one profile after the other from a station at a height
/// of 1.4.
std::vector<glm::dvec3> room(const glm::dvec3& at = glm::dvec3(0.0), double unit = 1) {
    std::vector<glm::dvec3> points;
    const glm::dvec3 station(.7, -.4, 1.4), low(-3, -2.5, 0), high(3, 2.5, 3);
    for (int line = 0; line < 500; ++line)
        for (int beam = 0; beam < 200; ++beam) {
            Random random(5, points.size());
            const double azimuth = 2 * M_PI * line / 500,
                         elevation = -1.05 + (M_PI / 2 + 1.05) * (beam + .5 * random.uniform()) / 200;
            const glm::dvec3 ray(std::cos(elevation) * std::cos(azimuth),
                                 std::cos(elevation) * std::sin(azimuth), std::sin(elevation));
            double range = INFINITY;
            for (int axis = 0; axis < 3; ++axis) {
                const double wall = ray[axis] > 0 ? high[axis] : low[axis];
                if (ray[axis] != 0) range = std::min(range, (wall - station[axis]) / ray[axis]);
            }
            points.push_back(at + (station + (range + .002 * (random.uniform() - .5)) * ray) / unit);
        }
    return points;
}

TEST(FindStations, FindsAllStationsOfVirtualScansAndInventsNone) {
    // At 50 000 points a station, 64 points of the nave span a whole profile, so heights are less exact.
    for (const auto& [scene, error] : {std::pair("nave", .3), {"cornell", .1}, {"two-rooms", .1}}) {
        const auto result = searched({.scene = scene, .points = 300'000});
        EXPECT_EQ(result.found.size(), result.stations.size()) << scene;
        EXPECT_LT(farthest(result.stations, result.found), error) << scene;
        EXPECT_LT(farthest(result.found, result.stations), error) << scene;
    }
}

TEST(FindStations, FindsTheSameHoweverThePointsComeInBatches) {
    const io::SyntheticOptions options{.scene = "two-rooms", .points = 60'000};
    EXPECT_EQ(searched(options).found, searched(options, 777).found);
}

TEST(FindStations, WorksFarFromTheOriginAndInFeet) {
    constexpr double kFoot = .3048;
    const glm::dvec3 far(1.5e6, 2e6, 900);
    const auto found = found_in(room(far, kFoot), kFoot);
    ASSERT_EQ(found.size(), 1u);
    EXPECT_LT(kFoot * glm::distance(found[0], far + glm::dvec3(.7, -.4, 1.4) / kFoot), .05);
}

TEST(FindStations, FindsALeaningScannerOnce) {
    const double lean = 3 * M_PI / 180;
    auto points = room();
    points.push_back({.7, -.4, 1.4});
    for (glm::dvec3& p : points)
        p = {p.x, std::cos(lean) * p.y - std::sin(lean) * p.z, std::sin(lean) * p.y + std::cos(lean) * p.z};
    const glm::dvec3 station = points.back();
    points.pop_back();
    const auto found = found_in(points);
    ASSERT_EQ(found.size(), 1u);
    EXPECT_LT(glm::distance(found[0], station), .2);
}

TEST(FindStations, FindsNoneWhereTheOrderIsLost) {
    auto points = room();
    ASSERT_EQ(found_in(points).size(), 1u);
    for (size_t i = points.size() - 1; i > 0; --i)
        std::swap(points[i], points[Random(7, i).next() % (i + 1)]);
    EXPECT_TRUE(found_in(points).empty()) << "random order";
    std::ranges::sort(points, {}, [](const glm::dvec3& p) { return std::tuple(p.x, p.y, p.z); });
    EXPECT_TRUE(found_in(points).empty()) << "sorted";
}

TEST(FindStations, FindsNoneInOtherClouds) {
    EXPECT_TRUE(searched({.scene = "survey", .points = 300'000}).found.empty()) << "a car's scan";
    for (const char* scene : {"nave", "statue", "primitives", "paraboloid"})
        EXPECT_TRUE(searched({.scene = scene, .points = 200'000, .even = true}).found.empty())
            << scene << ", sampled evenly";
    std::vector<glm::dvec3> plane, noise, spokes;
    for (int i = 0; i < 200'000; ++i) {
        Random random(9, static_cast<uint64_t>(i));
        plane.emplace_back(.01 * (i % 500), .01 * (i / 500), 0);
        noise.emplace_back(random.uniform(), random.uniform(), random.uniform());
        const double angle = .01 * (i / 200), distance = .02 * (1 + i % 200);
        spokes.emplace_back(distance * std::cos(angle), distance * std::sin(angle), 0);
    }
    EXPECT_TRUE(found_in(plane).empty()) << "rows of a plane";
    EXPECT_TRUE(found_in(noise).empty());
    EXPECT_TRUE(found_in(spokes).empty()) << "evenly spaced along spokes: no scanner's angles";
}

TEST(FindStations, TakesExtremeCloudsForNoScan) {
    EXPECT_TRUE(found_in({}).empty());
    EXPECT_TRUE(found_in(std::vector<glm::dvec3>(100'000, glm::dvec3(3.0))).empty());
    std::vector<glm::dvec3> huge;
    for (const glm::dvec3& point : room()) huge.push_back(1e30 * point);
    EXPECT_TRUE(found_in(huge).empty());
}

TEST(ScanRuns, KeepsEvenlySpreadRunsOfAnyNumberOfPoints) {
    io::Schema schema;
    ScanRuns runs;
    constexpr size_t kBatch = 10'000, kBatches = 100;
    for (size_t batch = 0; batch < kBatches; ++batch) {
        std::vector<glm::dvec3> points;
        for (size_t i = 0; i < kBatch; ++i)
            points.emplace_back(static_cast<double>(batch * kBatch + i) / ScanRuns::kRunPoints, 0, 0);
        runs.add(schema, std::as_bytes(std::span(points)));
    }
    constexpr size_t kRuns = kBatch * kBatches / ScanRuns::kRunPoints;
    ASSERT_EQ(runs.count(), (kRuns + 3) / 4) << "every fourth of 15625";
    for (size_t run = 0; run < runs.count(); ++run)
        for (size_t i = 0; i < ScanRuns::kRunPoints; ++i)
            ASSERT_EQ(runs.run(run)[i].x, static_cast<float>(4 * run) + static_cast<float>(i) / 64.f);
}

}  // namespace
}  // namespace lucarne::octree
