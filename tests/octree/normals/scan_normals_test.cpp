// Normals and orientation on virtual scans, whose true normals are known (io/synthetic).
#include <fmt/format.h>
#include <gtest/gtest.h>

#include "octree/normals/neighbours/point_index.h"
#include "tests/octree/normals/virtual_scans.h"

namespace lucarne::octree {
namespace {

using namespace testing;

Score print(const std::string& what, const Cloud& cloud, const NormalOptions& options, uint32_t parts) {
    const Score s = score(cloud, estimate(cloud, options, parts));
    std::printf("%-28s %7zu points: mean error %.2f degrees, oriented right %.4f, marked %.4f\n",
                what.c_str(), cloud.points.size(), s.angle, s.oriented, s.marked);
    return s;
}

TEST(ScanNormals, FollowTheTruthWhereStationsAreKnown) {
    const struct {
        const char* scene;
        double angle, oriented;
    } cases[] = {{"nave", 12, 0.995}, {"two-rooms", 4, 0.995}, {"statue", 2.5, 0.99}};
    for (const auto& c : cases) {
        const Scan scan = scan_of(c.scene, 300000);
        ASSERT_FALSE(scan.stations.empty());
        NormalOptions options;
        options.stations = scan.stations;
        const Score s = print(std::string(c.scene) + ", stations", scan.cloud, options, 2);
        EXPECT_LT(s.angle, c.angle) << c.scene;
        EXPECT_GT(s.oriented, c.oriented) << c.scene;
        EXPECT_LT(s.marked, 0.05) << c.scene;
    }
}

TEST(ScanNormals, FollowTheTruthOutsideWithoutStations) {
    Scan scan = scan_of("statue", 100000);
    for (const uint32_t parts : {1u, 3u}) {
        const Score s = print("statue, no stations", scan.cloud, {}, parts);
        EXPECT_GT(s.oriented, 0.95) << parts;
    }
}

TEST(ScanNormals, FollowTheTruthIndoorsWithoutStations) {
    for (const char* scene : {"nave", "two-rooms"}) {
        const Scan scan = scan_of(scene, 100000);
        for (const uint32_t parts : {1u, 3u}) {
            const Score s = print(std::string(scene) + ", no stations", scan.cloud, {}, parts);
            EXPECT_GT(s.oriented, 0.975) << scene << " " << parts;
        }
    }
}

/// Surfaces of all sides, as of a sampled mesh. What is below a statue or in a block has no side that is
/// seen, and the truth has one.
TEST(ScanNormals, FollowTheTruthOfEvenSamplesWithoutStations) {
    const struct {
        const char* scene;
        double oriented;
    } cases[] = {{"cornell", 0.998}, {"two-rooms", 0.96}, {"house", 0.98}, {"statue", 0.95}};
    for (const auto& c : cases) {
        Scan scan = scan_of(c.scene, 200000, true);
        scan.cloud.stations.clear();
        for (const uint32_t parts : {1u, 3u}) {
            const Score s = print(std::string(c.scene) + ", even", scan.cloud, {}, parts);
            EXPECT_GT(s.oriented, c.oriented) << c.scene << " " << parts;
        }
    }
}

/// Mixed pixels are found by their distance from an even sampling of the scene at a spacing of some
/// millimetres. Those that are still drawn must not be wide, because such a disc is visible in the air.
TEST(ScanNormals, MixedPixelsInTheAirAreLeftOutAndSurfacesAreNot) {
    constexpr double kInTheAir = 0.05;
    for (const char* scene : {"two-rooms", "nave"}) {
        // In the nave, points in front of dense walls are hard to tell from them.
        const Scan scan = scan_of(scene, std::string(scene) == "nave" ? 3000000 : 400000);
        const Scan truth = scan_of(scene, 2000000, true);
        NormalOptions options;
        options.stations = scan.stations;
        const Estimate found = estimate(scan.cloud, options);
        PointArrays surface;
        for (const auto& p : truth.cloud.points) surface.push_back(p);
        const auto index = make_flann_index(surface);
        size_t mixed = 0, mixed_drawn = 0, real = 0, real_left_out = 0;
        double area = 0;  // of discs in the air, m^2
        for (size_t i = 0; i < scan.cloud.points.size(); ++i) {
            Neighbour nearest;
            index->merge_nearest(scan.cloud.points[i], std::span(&nearest, 1), 0, 0);
            const bool stray = found.normals[i] == glm::vec3(0.0f) && found.areas[i] <= kStrayArea;
            if (nearest.distance2 > kInTheAir * kInTheAir)
                ++mixed, mixed_drawn += !stray, area += found.areas[i];
            else
                ++real, real_left_out += stray;
        }
        const double drawn =
            static_cast<double>(mixed_drawn) / static_cast<double>(std::max<size_t>(1, mixed));
        const double lost =
            static_cast<double>(real_left_out) / static_cast<double>(std::max<size_t>(1, real));
        std::printf(
            "%s: of %zu points in the air %.3f are left out, the others have %.2f m^2; of %zu on a "
            "surface %.5f are left out\n",
            scene, mixed, 1 - drawn, area, real, lost);
        EXPECT_GT(mixed, 10u) << scene;
        EXPECT_LT(drawn, 0.4) << scene;
        EXPECT_LT(area, 0.004 * static_cast<double>(mixed)) << scene;
        EXPECT_LT(lost, 0.002) << scene;
    }
}

}  // namespace
}  // namespace lucarne::octree
