#include "octree/cache/metadata.h"

#include <limits>
#include <string>

#include <gtest/gtest.h>

namespace lucarne::octree {
namespace {

TEST(Metadata, KeepsWhatWhiteIsInEachScansColours) {
    SourceHeader header;
    for (const uint32_t bits : {0u, 8u, 16u}) {
        io::ScanInfo scan;
        scan.color_bits = bits;
        header.scans.push_back(scan);
    }
    const auto read = parse_metadata("cache.luc", metadata_text(header));
    ASSERT_TRUE(read) << read.error().line();
    ASSERT_EQ(read->scans.size(), 3u);
    for (size_t i = 0; i < 3; ++i) EXPECT_EQ(read->scans[i].color_bits, header.scans[i].color_bits);
}

TEST(Metadata, RejectsColoursOfAnUnknownWidth) {
    SourceHeader header;
    header.scans.resize(1);
    std::string text = metadata_text(header);
    const size_t at = text.find("\"color_bits\": 8");
    ASSERT_NE(at, std::string::npos) << text;
    text.replace(at, 15, "\"color_bits\": 7");
    EXPECT_FALSE(parse_metadata("cache.luc", text));
}

SourceHeader with_colours() {
    SourceHeader header;
    header.scans.resize(2);
    header.station_colours = {{0, 3, {1.25, 1, 1 / 16.0}, glm::dvec3(0, 0.5, 1)}, {1, {}, {0.8, 1, 16}, {}}};
    return header;
}

TEST(Metadata, KeepsWhatIsKnownAboutStationsColours) {
    const auto read = parse_metadata("cache.luc", metadata_text(with_colours()));
    ASSERT_TRUE(read) << read.error().line();
    EXPECT_EQ(read->station_colours, with_colours().station_colours);
    EXPECT_EQ(metadata_text(SourceHeader{}).find("station_colours"), std::string::npos);
}

TEST(Metadata, RejectsImpossibleColoursOfStations) {
    const auto rejects = [](auto change) {
        SourceHeader header = with_colours();
        change(header.station_colours);
        return !parse_metadata("cache.luc", metadata_text(header));
    };
    EXPECT_FALSE(rejects([](auto&) {}));
    for (const double gain : {0.0, -1.0, 0.06, 16.01, 1e300, std::numeric_limits<double>::infinity(),
                              std::numeric_limits<double>::quiet_NaN()})
        EXPECT_TRUE(rejects([gain](auto& colours) { colours[1].gain.y = gain; })) << gain;
    for (const double colour : {-0.01, 1.01, std::numeric_limits<double>::quiet_NaN()})
        EXPECT_TRUE(rejects([colour](auto& colours) { colours[0].unphotographed->z = colour; })) << colour;
    EXPECT_TRUE(rejects([](auto& colours) { colours[1].scan = 2; })) << "there are two";
    EXPECT_TRUE(rejects([](auto& colours) { colours[0].station = 65536; })) << "an id is a u16";
    EXPECT_TRUE(rejects([](auto& colours) { std::swap(colours[0], colours[1]); })) << "not sorted";
    EXPECT_TRUE(rejects([](auto& colours) { colours[1] = colours[0]; })) << "twice";
    EXPECT_TRUE(rejects([](auto& colours) {
        for (uint32_t i = 0; i < 1024; ++i) colours.push_back({1, i, glm::dvec3(1), {}});
    })) << "too many";
}

SourceHeader with_stations() {
    SourceHeader header;
    header.scans.resize(3);
    header.scans[1].stations = {{1, {1, 2, 3}}};
    header.estimated_stations = {{0, {1.1, -2, 1e6}}, {0, {0, 0, .1}}, {2, {4, 5, 6}, true}};
    return header;
}

TEST(Metadata, KeepsEstimatedStationsApartFromStatedOnes) {
    const auto read = parse_metadata("cache.luc", metadata_text(with_stations()));
    ASSERT_TRUE(read) << read.error().line();
    EXPECT_EQ(read->estimated_stations, with_stations().estimated_stations);
    EXPECT_TRUE(read->scans[0].stations.empty());
    EXPECT_EQ(read->scans[1].stations.size(), 1u);
    EXPECT_EQ(metadata_text(SourceHeader{}).find("estimated_stations"), std::string::npos);
}

TEST(Metadata, RejectsImpossibleEstimatedStations) {
    const auto rejects = [](auto change) {
        SourceHeader header = with_stations();
        change(header.estimated_stations);
        return !parse_metadata("cache.luc", metadata_text(header));
    };
    EXPECT_FALSE(rejects([](auto&) {}));
    for (const double far :
         {1e32, -1e300, std::numeric_limits<double>::infinity(), std::numeric_limits<double>::quiet_NaN()})
        EXPECT_TRUE(rejects([far](auto& stations) { stations[1].position.y = far; })) << far;
    EXPECT_TRUE(rejects([](auto& stations) { stations[2].scan = 3; })) << "there are three";
    EXPECT_TRUE(rejects([](auto& stations) { stations[1].scan = 1; })) << "it states its own";
    EXPECT_TRUE(rejects([](auto& stations) { std::swap(stations[0], stations[2]); })) << "not sorted";
    EXPECT_TRUE(rejects([](auto& stations) { stations[0].saw_all = true; })) << "there is a second one";
    EXPECT_TRUE(rejects([](auto& stations) { stations[1].saw_all = true; })) << "there is a second one";
    EXPECT_TRUE(rejects([](auto& stations) { stations.resize(1025, {2, {4, 5, 6}, false}); })) << "too many";
    std::string text = metadata_text(with_stations());
    text.replace(text.find("\"estimated_stations\": ["), 23, "\"estimated_stations\": 7, \"x\": [");
    EXPECT_FALSE(parse_metadata("cache.luc", text)) << "no list";
}

}  // namespace
}  // namespace lucarne::octree
