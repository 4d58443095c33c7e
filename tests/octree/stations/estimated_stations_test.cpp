// Stations that are estimated: through the conversion, appending and export.
#include <memory>

#include <glm/geometric.hpp>
#include <gtest/gtest.h>

#include "io/synthetic/synthetic.h"
#include "octree/cache/cache.h"
#include "octree/convert/build.h"
#include "octree/convert/scans/scan_stage.h"
#include "octree/edit/edit.h"
#include "tests/octree/test_sources.h"

namespace lucarne::octree {
namespace {

using test::TempFolder;

/// A virtual scan of two rooms from four stations. `states`: it says where they were.
class Rooms final : public io::PointSource {
 public:
    explicit Rooms(bool states) {
        auto source = io::synthetic_source({.scene = "two-rooms", .points = 60'000});
        EXPECT_TRUE(source);
        source_ = std::move(*source);
        info_ = source_->info();
        for (const auto& station : info_.stations) stations.push_back(station.position);
        if (!states) info_.stations.clear();
        info_.path = states ? "stated" : "not stated";
    }
    const io::Schema& schema() const override { return source_->schema(); }
    const io::ScanInfo& info() const override { return info_; }
    Result<std::unique_ptr<io::PointReader>> open() const override { return source_->open(); }

    std::vector<glm::dvec3> stations;

 private:
    std::unique_ptr<io::PointSource> source_;
    io::ScanInfo info_;
};

BuildReport converted(std::vector<const io::PointSource*> inputs, const std::filesystem::path& output) {
    BuildOptions options;
    options.inputs = std::move(inputs);
    options.output = output;
    options.normals = NormalsMode::none;
    options.threads = 2;
    const auto report = build_cache(options);
    EXPECT_TRUE(report) << (report ? "" : report.error().line());
    return report ? *report : BuildReport{};
}

void expect_stations(const std::vector<EstimatedStation>& found, const std::vector<glm::dvec3>& stations,
                     uint32_t scan) {
    for (const glm::dvec3& station : stations) {
        size_t near = 0;
        for (const auto& estimated : found)
            near += estimated.scan == scan && glm::distance(estimated.position, station) < .3;
        EXPECT_EQ(near, 1u) << station.x << ' ' << station.y;
    }
}

TEST(EstimatedStations, AreKeptInTheCacheOfScansThatStateNone) {
    const TempFolder folder;
    const Rooms stated(true), silent(false);
    const auto output = folder / "two.luc";
    EXPECT_EQ(converted({&stated, &silent}, output).estimated_stations, 4u);
    const auto cache = open_cache(output);
    ASSERT_TRUE(cache) << cache.error().line();
    const auto& header = (*cache)->header();
    EXPECT_EQ(header.scans[0].stations.size(), 4u);
    EXPECT_TRUE(header.scans[1].stations.empty()) << "these would be exported";
    EXPECT_EQ(header.estimated_stations.size(), 4u);
    expect_stations(header.estimated_stations, silent.stations, 1);
}

TEST(EstimatedStations, StayWhenScansAreAppended) {
    const TempFolder folder;
    const Rooms first(false), second(false);
    const auto output = folder / "one.luc";
    converted({&first}, output);
    EditOptions options;
    options.cache = output;
    options.threads = 2;
    const auto report = append_to_cache({&second}, options);
    ASSERT_TRUE(report) << report.error().line();
    const auto cache = open_cache(output);
    ASSERT_TRUE(cache) << cache.error().line();
    EXPECT_EQ((*cache)->header().estimated_stations.size(), 8u);
    expect_stations((*cache)->header().estimated_stations, first.stations, 0);
    expect_stations((*cache)->header().estimated_stations, second.stations, 1);
}

TEST(EstimatedStations, AreRestoredWhenAConversionIsResumed) {
    ScanFacts facts;
    facts.stations = {{0, {1, 2, 3.25}}, {1, {2, 3, 4}, true}, {2, {-4, 5, 1e6}}};
    facts.spans = {{0, 0, 64, 1ull << 40}, {2, 2, 0, 128}};
    const auto record = facts.save();
    const auto restored = ScanFacts::restore(record);
    ASSERT_TRUE(restored);
    EXPECT_EQ(restored->stations, facts.stations);
    EXPECT_EQ(restored->spans, facts.spans);
    EXPECT_FALSE(ScanFacts::restore(std::span(record).first(record.size() - 1)));
}

}  // namespace
}  // namespace lucarne::octree
