// Every LAS and PLY file of the shared data, valid ones and deliberately bad ones.
#include <map>
#include <sstream>

#include <gmock/gmock.h>

#include "tests/io/io_testing.h"

namespace lucarne::io {
namespace {

using testing::read_all;

struct Entry {
    std::string file;
    size_t points = 0;
};

std::vector<Entry> manifest(const std::filesystem::path& folder, const std::string& begin,
                            const std::string& end) {
    std::vector<Entry> entries;
    std::ifstream in(folder / "manifest.tsv");
    for (std::string line; std::getline(in, line);) {
        std::vector<std::string> columns;
        std::istringstream cells(line);
        for (std::string cell; std::getline(cells, cell, '\t');) columns.push_back(cell);
        if (columns.size() < 5 || !columns[0].starts_with(begin) || !columns[0].ends_with(end)) continue;
        entries.push_back({columns[0], columns[4] == "?" ? 0 : std::stoul(columns[4])});
    }
    return entries;
}

class SharedScans : public ::testing::Test {
 protected:
    void SetUp() override {
        if (folder_.empty()) GTEST_SKIP() << "the shared data is not here";
    }
    void expect_counts(const std::string& begin, const std::string& end) const {
        const auto entries = manifest(folder_, begin, end);
        ASSERT_FALSE(entries.empty());
        for (const Entry& entry : entries) {
            // The manifest counts the vertices of meshes.
            const auto source = open_scan(folder_ / entry.file, {"", true, {0, 0, true}});
            ASSERT_TRUE(source) << source.error().line();
            EXPECT_EQ((*source)->info().declared_points, entry.points) << entry.file;
            const auto records = read_all(**source);
            ASSERT_TRUE(records) << records.error().line();
            EXPECT_EQ(records->count + records->dropped, entry.points) << entry.file;
        }
    }
    Error error_of(const std::string& file) const {
        const auto source = open_scan(folder_ / file);
        if (source) return {};
        return source.error();
    }
    const std::filesystem::path folder_ = testing::shared_data();
};

TEST_F(SharedScans, EveryLasFileHasThePointsOfTheManifest) {
    expect_counts("las/", ".las");
}
TEST_F(SharedScans, EveryPlyFileHasThePointsOfTheManifest) {
    expect_counts("ply/", ".ply");
}

TEST_F(SharedScans, EveryPcdFileHasThePointsOfTheManifest) {
    expect_counts("pcd/", ".pcd");
}
TEST_F(SharedScans, EveryPtxFileHasThePointsOfTheManifest) {
    expect_counts("ptx_pts/", ".ptx");
}

TEST_F(SharedScans, WhatLazOfOldOrUnknownMakeIsRefusedByName) {
    const std::map<std::string, std::string> reasons = {
        {"las/point-version-1-point-wise.laz", "old LASzip item version 1"},
        {"las/simple-laszip-compressor-version-1.2r0.laz", "old LASzip item version 1"},
        {"las/fullwave.laz", "compressed point format 10 (wave packets)"},
        {"bad/laszip_broken_coder.laz", "unknown LASzip coder 15"},
        {"bad/laszip_broken_compressor.laz", "unknown LASzip compressor 16"},
        {"bad/laszip_broken_size.laz", "unknown LASzip item version 6"},
    };
    for (const auto& [file, reason] : reasons) {
        const Error error = error_of(file);
        EXPECT_EQ(error.kind, ErrorKind::input_rejected) << file;
        EXPECT_THAT(error.line(), ::testing::HasSubstr(reason)) << file;
    }
}

TEST_F(SharedScans, BadFilesAreRejectedWithTheReasonOrReadAsDocumented) {
    EXPECT_THAT(error_of("bad/pdal_garbage_nVariableLength.las").line(),
                ::testing::HasSubstr("719 points, 718 are there"));
    EXPECT_THAT(error_of("bad/pdal_no_vertex.ply").line(), ::testing::HasSubstr("no vertex element"));
    EXPECT_THAT(error_of("bad/pdal_badheader.txt").line(),
                ::testing::HasSubstr("'X,Y,X' does not name the 3 columns"));
    EXPECT_THAT(error_of("bad/pdal_missingheader.pcd").line(), ::testing::HasSubstr("its PCD header "));
    // Too few records, a time that is no number, and no points at all do not affect the points.
    const std::map<std::string, size_t> readable = {
        {"bad/pdal_bad_vlr_count.las", 10}, {"bad/pdal_gps-time-nan.las", 1}, {"bad/pdal_no-points.las", 0}};
    for (const auto& [file, points] : readable) {
        const auto source = open_scan(folder_ / file);
        ASSERT_TRUE(source) << source.error().line();
        const auto records = read_all(**source);
        ASSERT_TRUE(records) << records.error().line();
        EXPECT_EQ(records->count, points) << file;
    }
}

TEST_F(SharedScans, DamagedE57FilesAreRejectedAndEmptyOnesAreEmpty) {
    EXPECT_THAT(error_of("bad/e57_bad-crc.e57").line(), ::testing::HasSubstr("the page at byte 0 is wrong"));
    EXPECT_THAT(error_of("bad/e57_corrupt_crc.e57").line(),
                ::testing::HasSubstr("the page at byte 33792 is wrong"));
    // Their only scan has no points; in the first file its section was never written.
    for (const char* file : {"bad/e57_InvalidCVHeader.e57", "bad/e57_empty_pc.e57"}) {
        const auto source = open_scan(folder_ / file);
        ASSERT_TRUE(source) << source.error().line();
        const auto records = read_all(**source);
        ASSERT_TRUE(records) << records.error().line();
        EXPECT_EQ(records->count, 0u);
    }
}

}  // namespace
}  // namespace lucarne::io
