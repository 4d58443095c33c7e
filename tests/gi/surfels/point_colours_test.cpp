#include "gi/surfels/point_colours.h"

#include <glm/common.hpp>
#include <glm/vector_relational.hpp>
#include <gtest/gtest.h>

#include "gi/shared/luminance.h"
#include "gi/shared/surfel_code.h"
#include "gi/surfels/surfel_pool.h"
#include "octree/colours/even_colours.h"

namespace lucarne::gi {
namespace {

/// A node of 16 m with points of two stations.
struct Node {
    Node() {
        header.root = {{0, 0, 0}, 16};
        header.max = glm::dvec3(16);
        header.schema.add("color", io::ScalarType::u8, 3);
        header.schema.add("point_source_id", io::ScalarType::u16);
        header.scans.resize(1);
    }
    void add(const glm::dvec3& position, const std::array<uint8_t, 3>& color, uint16_t station = 1) {
        data.records.resize(data.records.size() + header.schema.stride);
        std::byte* record = &data.records[data.records.size() - header.schema.stride];
        io::store(record, position);
        io::store(record + 24, color);
        io::store(record + 27, station);
        ++data.count;
    }
    /// Returns the linear colours that engines see.
    std::vector<glm::vec3> colours(bool balance = true, const glm::dvec3& white = glm::dvec3(1)) const {
        Scene scene;
        scene.materials.resize(1);
        scene.albedo.balance = balance;
        scene.albedo.white = white;
        octree::NodeInfo info;
        info.count = data.count;
        std::vector<glm::vec3> result;
        for (const PackedSurfel& surfel : pack_surfels(header, info, data, scene))
            result.push_back(decode_albedo(surfel.d));
        return result;
    }

    octree::SourceHeader header;
    octree::NodeData data;
};

void expect_near(const glm::vec3& a, const glm::vec3& b, float share = 0.01f) {
    for (int c = 0; c < 3; ++c) EXPECT_NEAR(a[c], b[c], share * std::max(b[c], 0.02f)) << "channel " << c;
}
glm::vec3 linear(float r, float g, float b) {
    return {srgb_to_linear(r / 255), srgb_to_linear(g / 255), srgb_to_linear(b / 255)};
}

TEST(PointColours, AStationsGainMultipliesItsLinearColours) {
    Node node;
    node.header.station_colours = {{0, 1, {2, 0.5, 1.5}, {}}, {0, 2, {0.5, 2, 1}, {}}};
    node.add({1, 1, 1}, {100, 150, 3}, 1);
    node.add({1, 1, 1}, {100, 150, 3}, 2);
    node.add({1, 1, 1}, {100, 150, 3}, 7);
    node.add({1, 1, 1}, {255, 255, 0}, 1);
    const auto colours = node.colours();
    const glm::vec3 own = linear(100, 150, 3);
    expect_near(colours[0], own * glm::vec3(2, 0.5, 1.5));
    expect_near(colours[1], own * glm::vec3(0.5, 2, 1));
    expect_near(colours[2], own);
    expect_near(colours[3], {1, 0.5, 0});
    for (size_t i = 0; i < 3; ++i) expect_near(node.colours(false)[i], own);
}

TEST(PointColours, ChangesEvenColoursOutBeforeGains) {
    Node node;
    node.header.schema.add("color_change", io::ScalarType::i8, 3);
    node.header.station_colours = {{0, 1, {2, 2, 2}, {}}};
    node.add({1, 1, 1}, {51, 102, 250});
    io::store(&node.data.records[29], octree::ColourChange{-6, 12, 70});
    const auto changed = node.colours();
    expect_near(changed[0], {2 * srgb_to_linear(0.2f + 6 / 32.0f), 2 * srgb_to_linear(0.4f - 6 / 32.0f), 1});
    expect_near(node.colours(false)[0], linear(51, 102, 250));
}

TEST(PointColours, TheLightOfTheScanIsDividedOutOfColoursThatPointsHave) {
    Node node;
    node.header.station_colours = {{0, 2, glm::dvec3(2), {}}};
    const glm::vec3 paint(0.2f), lamp(1.8f, 0.9f, 0.4f);
    const glm::vec3 seen = paint * lamp / luminance(lamp);
    std::array<uint8_t, 3> code{};
    for (int c = 0; c < 3; ++c)
        code[static_cast<size_t>(c)] = static_cast<uint8_t>(255 * linear_to_srgb(seen[c]) + 0.5f);
    node.add({1, 1, 1}, code);
    node.add({1, 1, 1}, code, 2);
    node.add({1, 1, 1}, {255, 255, 255});
    for (const double brightness : {0.01, 1.0, 500.0}) {
        const auto colours = node.colours(true, brightness * glm::dvec3(lamp));
        expect_near(colours[0], paint, 0.02f);
        expect_near(colours[1], 2.0f * paint, 0.02f);
        EXPECT_EQ(colours[2].z, 1.0f) << "no more than all light is reflected";
    }
    Node none;
    none.header.schema = {};
    none.header.schema.add("intensity", io::ScalarType::u16);
    none.data.records.resize(none.header.schema.stride);
    none.data.count = 1;
    const auto grey = none.colours(true, lamp)[0];
    EXPECT_EQ(grey, glm::vec3(grey.x)) << "of a point without a colour";
}

TEST(PointColours, AnEntryWithoutAStationIsForTheWholeScan) {
    Node node;
    node.header.station_colours = {{0, {}, glm::dvec3(3), {}}};
    node.add({1, 1, 1}, {100, 100, 100}, 5);
    expect_near(node.colours()[0], 3.0f * linear(100, 100, 100));
}

TEST(PointColours, NeverPhotographedPointsGetTheColourAroundThem) {
    Node node;
    node.header.station_colours = {{0, 1, glm::dvec3(1), glm::dvec3(0.3)}, {0, 2, glm::dvec3(2), {}}};
    node.add({2, 2, 2}, {0, 0, 0});
    node.add({2.1, 2, 2}, {200, 100, 50});
    node.add({14, 2, 2}, {0, 0, 0});
    node.add({14.1, 2, 2}, {50, 100, 150}, 2);
    node.add({8, 15, 15}, {0, 0, 0}, 2);
    const auto colours = node.colours();
    expect_near(colours[0], colours[1]);
    expect_near(colours[2], 2.0f * linear(50, 100, 150));
    EXPECT_EQ(colours[4], glm::vec3(0)) << "station 2 has seen black";
    EXPECT_EQ(node.colours(false)[0], glm::vec3(0));
}

TEST(PointColours, FarFromColoursAllOfTheNodeCountAndWithoutAnyTheStationsMean) {
    Node node;
    node.header.station_colours = {{0, {}, {1, 2, 1}, glm::dvec3(0.3, 0.2, 0.7)}};
    node.add({15, 15, 15}, {0, 0, 0});
    expect_near(node.colours()[0], {0.3f, 0.4f, 0.7f});
    node.add({1, 1, 1}, {200, 100, 50});
    node.add({1, 1, 1}, {200, 100, 50});
    expect_near(node.colours()[0], node.colours()[1]);
}

TEST(PointColours, PointsBetweenColoursAreBetweenThem) {
    Node node;
    node.header.station_colours = {{0, {}, glm::dvec3(1), glm::dvec3(0.3)}};
    node.add({4.25, 4.25, 4.25}, {200, 200, 200});
    node.add({4.75, 4.25, 4.25}, {100, 100, 100});
    node.add({4.5, 4.25, 4.25}, {0, 0, 0});
    const auto colours = node.colours();
    expect_near(colours[2], (colours[0] + colours[1]) * 0.5f);
}

TEST(PointColours, TheLastPixelsOfAPhotographAreNotBlackEither) {
    Node node;
    node.header.station_colours = {{0, {}, glm::dvec3(1), glm::dvec3(0.3)}};
    node.add({2, 2, 2}, {0, 0, 0});
    node.add({2.1, 2, 2}, {200, 100, 50});
    node.add({2.2, 2, 2}, {10, 5, 2});
    node.add({9, 9, 9}, {10, 5, 2});
    const auto colours = node.colours();
    expect_near(colours[2], colours[1]);
    expect_near(colours[3], linear(10, 5, 2));
}

TEST(PointColours, HostilePlacesAndUnknownScansDoNoHarm) {
    Node node;
    node.header.station_colours = {{0, {}, glm::dvec3(16), glm::dvec3(0.3)}};
    for (const double far : {-1e300, 1e300, 16.0, 17.0}) {
        node.add(glm::dvec3(far), {0, 0, 0});
        node.add(glm::dvec3(far), {9, 9, 9});
    }
    for (const auto& colour : node.colours())
        EXPECT_TRUE(glm::all(glm::greaterThanEqual(colour, glm::vec3(0))));
    node.header.scans.clear();
    EXPECT_EQ(node.colours().size(), 8u);
}

}  // namespace
}  // namespace lucarne::gi
