// Estimated stations in use: the surface of scans that state none.
#include <fstream>
#include <iterator>

#include "octree/edit/edit.h"
#include "tests/octree/stations/silent_scans.h"

namespace lucarne::octree {
namespace {

using test::StationScan;
using test::SurfaceScore;
using test::TempFolder;

std::string bytes_of(const std::filesystem::path& path) {
    std::ifstream file(path, std::ios::binary);
    return {std::istreambuf_iterator<char>(file), {}};
}

SurfaceScore score_of_scan(const std::string& scene, uint64_t points, bool states, uint32_t stations = 0) {
    const TempFolder folder;
    const StationScan scan(scene, points, states, stations);
    test::converted({&scan}, folder / "scan.luc");
    const auto cache = open_cache(folder / "scan.luc");
    EXPECT_TRUE(cache);
    return cache ? test::score_of(**cache) : SurfaceScore{};
}

// Without stations, 2.5, .8 and 2.4 % of the normals are flipped (300k points).
TEST(UsedStations, TurnNormalsOfScansThatStateNone) {
    for (const auto& [scene, points] :
         {std::pair("nave", 300'000), {"house", 100'000}, {"two-rooms", 100'000}}) {
        const auto score = score_of_scan(scene, static_cast<uint64_t>(points), false);
        std::printf("%s: %.3f %% of %zu normals flipped\n", scene, 100 * score.flipped_share(),
                    static_cast<size_t>(score.with_normal));
        EXPECT_LT(score.flipped_share(), .005) << scene;
    }
}

// The station tells from which side of a thin wall a point was seen, and which plane is a curtain.
TEST(UsedStations, ServeAsStatedOnesDo) {
    const auto stated = score_of_scan("cornell", 60'000, true),
               silent = score_of_scan("cornell", 60'000, false);
    EXPECT_LE(silent.flipped, 1.1 * static_cast<double>(stated.flipped) + 10);
    EXPECT_NEAR(static_cast<double>(silent.strays), static_cast<double>(stated.strays), 2);
}

TEST(UsedStations, AreNoneWhereTheOrderOfThePointsIsLost) {
    const TempFolder folder;
    const StationScan scan("two-rooms", 60'000, false);
    const auto lost = test::shuffled(scan);
    EXPECT_EQ(test::converted({lost.get()}, folder / "scan.luc").estimated_stations, 0u);
    const auto cache = open_cache(folder / "scan.luc");
    ASSERT_TRUE(cache);
    EXPECT_GT(test::score_of(**cache).with_normal, 59'000u);
}

TEST(UsedStations, MayBeTheOnlyOneOfTheirScan) {
    const TempFolder folder;
    const StationScan one("cornell", 60'000, false, 1), other("two-rooms", 60'000, false);
    EXPECT_EQ(test::converted({&one, &other}, folder / "both.luc").estimated_stations, 5u);
    const auto cache = open_cache(folder / "both.luc");
    ASSERT_TRUE(cache);
    const auto& stations = (*cache)->header().estimated_stations;
    ASSERT_EQ(stations.size(), 5u);
    for (const auto& station : stations) EXPECT_EQ(station.saw_all, station.scan == 0);
}

TEST(UsedStations, GiveTheSameCacheForAnyNumberOfThreads) {
    const TempFolder folder;
    const StationScan first("two-rooms", 40'000, false), second("cornell", 30'000, false);
    for (const unsigned threads : {1u, 3u})
        test::converted({&first, &second}, folder / std::to_string(threads), threads, 64 << 20);
    EXPECT_EQ(bytes_of(folder / "1"), bytes_of(folder / "3"));
}

TEST(UsedStations, TurnNormalsOfAppendedScans) {
    const TempFolder folder;
    const StationScan first("cornell", 30'000, false), second("two-rooms", 60'000, false);
    test::converted({&first}, folder / "scans.luc");
    EditOptions options;
    options.cache = folder / "scans.luc";
    options.threads = 2;
    const auto report = append_to_cache({&second}, options);
    ASSERT_TRUE(report) << report.error().line();
    const auto cache = open_cache(folder / "scans.luc");
    ASSERT_TRUE(cache);
    EXPECT_EQ((*cache)->header().estimated_stations.size(), 7u);
    EXPECT_LT(test::score_of(**cache, 1).flipped_share(), .005);
}

}  // namespace
}  // namespace lucarne::octree
