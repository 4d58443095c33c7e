// Which station saw which points of a scan, from their order alone.
#include "octree/stations/station_spans.h"

#include <algorithm>

#include <glm/geometric.hpp>
#include <gtest/gtest.h>

#include "io/core/random.h"
#include "octree/stations/find_stations.h"
#include "tests/octree/stations/silent_scans.h"

namespace lucarne::octree {
namespace {

using test::StationScan;

/// The points of a virtual scan, with the station that truly saw each.
struct Points {
    std::vector<glm::dvec3> positions;
    std::vector<size_t> stations;
    std::vector<glm::dvec3> places;  ///< of the stations

    Points(const std::string& scene, uint64_t count, uint32_t wanted = 0) {
        const StationScan scan(scene, count, false, wanted);
        places = scan.stations;
        const auto* truth = scan.schema().find(StationScan::kTrueStation);
        const auto reader = scan.open();
        io::PointBatch batch;
        while (reader && (*reader)->read(batch, 65536).value_or(0) > 0)
            for (size_t i = 0; i < batch.count; ++i) {
                const std::byte* record = &batch.bytes[i * scan.schema().stride];
                positions.push_back(io::position_of(scan.schema(), record));
                stations.push_back(io::load<uint16_t>(record + truth->offset) - size_t{1});
            }
    }
    void swap(size_t a, size_t b) {
        std::swap(positions[a], positions[b]);
        std::swap(stations[a], stations[b]);
    }
    /// Mixes the points [first, end) at random.
    void shuffle(size_t first, size_t end) {
        for (size_t i = end - 1; i > first; --i) swap(i, first + Random(3, i).next() % (i - first + 1));
    }
};

struct Labels {
    size_t stations = 0;
    std::vector<StationSpan> spans;
    double known = 0, wrong = 0;  ///< shares of the points
    bool all = false;
};
Labels labels_of(const Points& points) {
    ScanRuns runs;
    runs.add(io::Schema{}, std::as_bytes(std::span(points.positions)));
    const auto found = find_stations(runs, 1);
    Labels labels{.stations = found.size(), .spans = station_spans(runs, found, 1)};
    labels.all = saw_all(runs, labels.spans);
    uint64_t end = 0;
    for (const StationSpan& span : labels.spans) {
        EXPECT_GE(span.first, end) << "spans overlap";
        EXPECT_LT(span.first, span.end);
        EXPECT_LE(span.end, points.positions.size());
        end = std::min<uint64_t>(span.end, points.positions.size());
        for (uint64_t i = span.first; i < end; ++i) {
            labels.known += 1;
            labels.wrong += glm::distance(found[span.station], points.places[points.stations[i]]) > .5;
        }
    }
    labels.known /= static_cast<double>(points.positions.size());
    labels.wrong /= static_cast<double>(points.positions.size());
    return labels;
}

TEST(StationSpans, CoverNearlyAllPointsOfVirtualScansAndHardlyAnyWrongOne) {
    const struct {
        const char* scene;
        double known;
    } cases[] = {{"nave", .99}, {"house", .94}, {"cornell", .99}, {"two-rooms", .99}};
    for (const auto& c : cases) {
        const Points points(c.scene, 100'000);
        const Labels labels = labels_of(points);
        EXPECT_EQ(labels.stations, points.places.size()) << c.scene;
        EXPECT_GT(labels.known, c.known) << c.scene;
        EXPECT_LT(labels.wrong, .001) << c.scene;
    }
}

TEST(StationSpans, OfTheOnlyStationAreAllOfTheScan) {
    EXPECT_TRUE(labels_of(Points("cornell", 60'000, 1)).all);
    Points half("cornell", 60'000, 1);
    half.shuffle(half.positions.size() / 2, half.positions.size());
    EXPECT_FALSE(labels_of(half).all) << "the other half may be from anywhere";
}

TEST(StationSpans, EndWhereTheOrderIsLost) {
    Points points("two-rooms", 100'000);
    const size_t first = points.positions.size() * 3 / 8, end = points.positions.size() * 5 / 8;
    points.shuffle(first, end);
    const Labels labels = labels_of(points);
    EXPECT_EQ(labels.stations, points.places.size());
    EXPECT_LT(labels.wrong, .001);
    for (const StationSpan& span : labels.spans)
        EXPECT_TRUE(span.end <= first + ScanRuns::kRunPoints || span.first + ScanRuns::kRunPoints >= end);
}

TEST(StationSpans, GoOnInPiecesWhereStationsTakeTurns) {
    const Points scan("two-rooms", 100'000);
    Points turns = scan;  // a quarter of each station's points, then the next quarter of each
    turns.positions.clear(), turns.stations.clear();
    for (size_t quarter = 0; quarter < 4; ++quarter)
        for (size_t station = 0; station < scan.places.size(); ++station) {
            std::vector<size_t> own;
            for (size_t i = 0; i < scan.stations.size(); ++i)
                if (scan.stations[i] == station) own.push_back(i);
            for (size_t i = quarter * own.size() / 4; i < (quarter + 1) * own.size() / 4; ++i) {
                turns.positions.push_back(scan.positions[own[i]]);
                turns.stations.push_back(station);
            }
        }
    const Labels labels = labels_of(turns);
    EXPECT_EQ(labels.stations, turns.places.size());
    EXPECT_GT(labels.spans.size(), 12u);
    EXPECT_GT(labels.known, .9);
    EXPECT_LT(labels.wrong, .002);
}

TEST(StationSpans, AreNoneWithoutStationsOrLines) {
    const Points points("cornell", 60'000);
    ScanRuns runs, noise;
    runs.add(io::Schema{}, std::as_bytes(std::span(points.positions)));
    EXPECT_TRUE(station_spans(runs, {}, 1).empty());
    std::vector<glm::dvec3> random;
    for (uint64_t i = 0; i < 50'000; ++i) {
        Random of(4, i);
        random.emplace_back(of.uniform(), of.uniform(), of.uniform());
    }
    noise.add(io::Schema{}, std::as_bytes(std::span(random)));
    EXPECT_TRUE(station_spans(noise, {{.5, .5, .5}, {2, 2, 2}}, 1).empty());
    EXPECT_TRUE(station_spans(runs, std::vector<glm::dvec3>(64, glm::dvec3(NAN)), 1).empty());
}

}  // namespace
}  // namespace lucarne::octree
