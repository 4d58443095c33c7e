// Exports of a part of the points.
#include <algorithm>
#include <cmath>
#include <string>
#include <string_view>
#include <vector>

#include <glm/geometric.hpp>
#include <gtest/gtest.h>

#include "io/core/random.h"
#include "octree/convert/build.h"
#include "octree/export/export.h"
#include "octree/open.h"
#include "tests/octree/test_sources.h"

namespace lucarne::octree {
namespace {

using test::TempFolder;

/// A square of 10 m with 200 000 points, whose intensity is the point's number modulo 1000.
class ExportSelection : public testing::Test {
 protected:
    void SetUp() override {
        io::Schema schema;
        schema.position = io::PositionType::f64;
        schema.add("intensity", io::ScalarType::u16);
        schema.add("gps_time", io::ScalarType::f64);
        const test::ComputedSource square(schema, 200'000, [&](uint64_t index, std::byte* record) {
            Random random(3, index);
            io::store(record, 10 * random.uniform());
            io::store(record + 8, 10 * random.uniform());
            io::store(record + 16, 0.0);
            io::store(record + 24, static_cast<uint16_t>(index % 1000));
            io::store(record + 26, static_cast<double>(index));
        });
        ASSERT_TRUE(
            build_cache({.inputs = {&square}, .output = folder_ / "a.luc", .normals = NormalsMode::none}));
        auto source = open_octree(folder_ / "a.luc");
        ASSERT_TRUE(source) << source.error().line();
        source_ = std::move(*source);
    }
    struct Written {
        uint64_t points = 0, progress = 0;
        io::Schema schema;
        std::vector<std::string> records;  ///< sorted
        std::vector<glm::dvec3> positions;
    };
    Written write(const ExportOptions& options, const char* name = "out.ply") const {
        Written written;
        const Exporter exporter(*source_, options);
        const auto path = folder_ / name;
        const auto count = [&](uint64_t done) { written.progress += done; };
        Result<uint64_t> points = 0;
        if (std::string_view(name).ends_with(".copc.laz")) {
            points = exporter.write_copc(path, true, count);
        } else {
            const auto writer =
                io::create_scan(path, exporter.schema(), exporter.info(), exporter.write_options(true));
            EXPECT_TRUE(writer) << writer.error().line();
            points = exporter.write(**writer, count);
        }
        EXPECT_TRUE(points) << points.error().line();
        written.points = points.value_or(0);
        const auto scan = io::open_scan(path, {"", true, {0, 0, true}});
        EXPECT_TRUE(scan) << scan.error().line();
        written.schema = (*scan)->schema();
        written.records = test::sorted_records(**scan, written.schema.stride);
        for (const auto& record : written.records)
            written.positions.push_back(
                io::position_of(written.schema, reinterpret_cast<const std::byte*>(record.data())));
        EXPECT_EQ(written.records.size(), written.points);
        EXPECT_EQ(written.progress, source_->header().points) << "progress ends at the whole";
        return written;
    }
    const TempFolder folder_;
    std::unique_ptr<NodeSource> source_;
};

TEST_F(ExportSelection, OfAPartAndOfItsComplementIsTheWhole) {
    ExportOptions inside, outside;
    const auto in_circle = [](const glm::dvec3& p) { return glm::length(p - glm::dvec3(4, 5, 0)) < 2; };
    inside.keeps = [&](const glm::dvec3& p, const std::byte*) { return in_circle(p); };
    outside.keeps = [&](const glm::dvec3& p, const std::byte*) { return !in_circle(p); };
    // Cubes that miss the circle's box are not read.
    inside.meets = [](const Cube& cube) {
        return cube.min.x < 6 && cube.min.x + cube.size > 2 && cube.min.y < 7 && cube.min.y + cube.size > 3;
    };
    Written in = write(inside);
    const Written out = write(outside), all = write({});
    EXPECT_NEAR(static_cast<double>(in.points), 200'000 * std::acos(-1.0) * 4 / 100, 600);
    in.records.insert(in.records.end(), out.records.begin(), out.records.end());
    std::sort(in.records.begin(), in.records.end());
    EXPECT_TRUE(in.records == all.records);
    const Written copc = write(inside, "out.copc.laz");
    EXPECT_EQ(copc.points + out.points, all.points);
}

TEST_F(ExportSelection, SpacingThinsEvenlyToWhatWasAskedFor) {
    for (const double spacing : {.05, .2, .8}) {
        ExportOptions options;
        options.spacing = spacing;
        const Written thinned = write(options);
        const double apart = std::sqrt(100.0 / static_cast<double>(thinned.points));
        EXPECT_GE(apart, .8 * spacing);
        EXPECT_LE(apart, 2 * spacing);
        // No part of the square is left empty.
        std::vector<int> cells(25, 0);
        for (const glm::dvec3& p : thinned.positions)
            ++cells[static_cast<size_t>(std::min(p.x / 2, 4.0)) +
                    5 * static_cast<size_t>(std::min(p.y / 2, 4.0))];
        EXPECT_GT(*std::min_element(cells.begin(), cells.end()), 0) << spacing;
    }
    ExportOptions finer;
    finer.spacing = 1e-6;
    EXPECT_EQ(write(finer).points, 200'000u);
}

TEST_F(ExportSelection, EveryNthPointIsCountedOverAllNodes) {
    ExportOptions options;
    options.every = 7;
    EXPECT_EQ(write(options).points, (200'000u + 6) / 7);
    options.keeps = [](const glm::dvec3& p, const std::byte*) { return p.x < 5; };
    const uint64_t half = write({.keeps = options.keeps}).points;
    EXPECT_EQ(write(options).points, (half + 6) / 7) << "of those that are left";
}

TEST_F(ExportSelection, PositionsAreRoundedToThePrecision) {
    glm::dvec3 exact(0.0);
    for (const glm::dvec3& p : write({}).positions) exact += p;
    for (const char* name : {"out.las", "out.ply", "out.copc.laz"}) {
        const Written rounded = write({.precision = .01}, name);
        ASSERT_EQ(rounded.points, 200'000u);
        glm::dvec3 sum(0.0);
        for (const glm::dvec3& p : rounded.positions) {
            for (int axis = 0; axis < 3; ++axis) ASSERT_NEAR(p[axis] * 100, std::round(p[axis] * 100), 1e-6);
            sum += p;
        }
        EXPECT_NEAR(sum.x / 200'000, exact.x / 200'000, 1e-4) << name << ": nothing is shifted";
    }
    EXPECT_FALSE(check_precision(source_->header(), 1e-9));
    EXPECT_TRUE(check_precision(source_->header(), 1e-8));
}

TEST_F(ExportSelection, KeepsOnlyTheAttributesThatAreNamed) {
    for (const char* name : {"out.ply", "out.las", "out.csv"}) {
        const Written one = write({.attributes = {"gps_time"}}, name);
        EXPECT_EQ(one.points, 200'000u);
        EXPECT_TRUE(one.schema.find("gps_time")) << name;
        if (std::string_view(name) != "out.las") {  // LAS points always have one
            EXPECT_FALSE(one.schema.find("intensity")) << name;
        }
    }
}

TEST_F(ExportSelection, OfNothingIsAFileWithoutPoints) {
    ExportOptions nothing;
    nothing.meets = [](const Cube&) { return false; };
    EXPECT_EQ(write(nothing).points, 0u);
    EXPECT_EQ(write(nothing, "out.las").points, 0u);
    EXPECT_EQ(write(nothing, "out.copc.laz").points, 0u);
}

}  // namespace
}  // namespace lucarne::octree
