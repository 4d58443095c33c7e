// Tests `lucarne convert --append` as a user runs it.
#include <filesystem>
#include <fstream>

#include <fmt/format.h>
#include <gtest/gtest.h>

#include "octree/cache/cache.h"
#include "tests/viewer/program.h"

namespace lucarne::test {
namespace {

namespace fs = std::filesystem;

class AppendCommand : public ::testing::Test {
 protected:
    static void write(const std::string& file, const std::string& rows) { std::ofstream(file) << rows; }
    static Outcome convert(const std::string& inputs, const std::string& cache,
                           const std::string& options = {}) {
        return lucarne(fmt::format("convert --normals none {} -o {} {}", inputs, cache, options));
    }
    static Outcome append(const std::string& inputs, const std::string& cache,
                          const std::string& options = {}) {
        return lucarne(fmt::format("convert --append {} -o {} {}", inputs, cache, options));
    }
    static octree::SourceHeader header_of(const std::string& cache) {
        return octree::open_cache(cache).value()->header();
    }

    const TemporaryFolder folder_;
    const std::string cache_ = folder_ / "a.luc";
};

TEST_F(AppendCommand, TakesScansInTheCachesUnitAndRefusesEveryOther) {
    write(folder_ / "a.xyz", "0 0 0\n10 10 10\n");
    write(folder_ / "b.xyz", "1 2 3\n20 20 20\n");
    const std::vector<std::string> units = {"m", "cm", "mm", "km", "ft", "us-ft", "in"};
    for (const auto& of_cache : units) {
        ASSERT_EQ(convert(folder_ / "a.xyz", cache_, "--overwrite --unit " + of_cache).code, 0);
        const std::string before = bytes_of(cache_);
        for (const auto& of_scan : units) {
            if (of_scan == of_cache) continue;
            const auto refused = append(folder_ / "b.xyz", cache_, "--unit " + of_scan);
            EXPECT_EQ(refused.code, 3) << of_scan << " into " << of_cache << '\n' << refused.output;
            EXPECT_NE(refused.output.find("b.xyz: has a unit of "), std::string::npos) << refused.output;
            EXPECT_EQ(bytes_of(cache_), before) << of_scan << " into " << of_cache;
        }
        const auto same = append(folder_ / "b.xyz", cache_, "--unit " + of_cache);
        ASSERT_EQ(same.code, 0) << same.output;
        EXPECT_EQ(same.output.find("does not say its unit"), std::string::npos) << same.output;
        EXPECT_EQ(header_of(cache_).max, glm::dvec3(20)) << of_cache;
    }
}

TEST_F(AppendCommand, TakesAScanThatStatesNoUnitToBeInTheCachesAndSaysSo) {
    write(folder_ / "a.xyz", "0 0 0\n10 10 10\n");
    write(folder_ / "b.xyz", "1 2 3\n20 20 20\n");
    ASSERT_EQ(convert(folder_ / "a.xyz", cache_, "--unit ft").code, 0);
    const auto added = append(folder_ / "b.xyz", cache_);
    ASSERT_EQ(added.code, 0) << added.output;
    EXPECT_NE(added.output.find("b.xyz: does not say its unit"), std::string::npos) << added.output;
    EXPECT_EQ(header_of(cache_).max, glm::dvec3(20));
}

TEST_F(AppendCommand, TakesTheSearchForNeighboursThatWasAskedFor) {
    ASSERT_EQ(lucarne("generate two-rooms --points 3k --seed 1 -o " + (folder_ / "a.las")).code, 0);
    ASSERT_EQ(lucarne("generate two-rooms --points 3k --seed 2 -o " + (folder_ / "b.las")).code, 0);
    ASSERT_EQ(lucarne("convert " + (folder_ / "a.las") + " -o " + cache_).code, 0);
    const std::string before = bytes_of(cache_);
    for (const char* search : {"leaf", "flann"}) {
        std::ofstream(cache_, std::ios::binary) << before;
        const auto added =
            append(folder_ / "b.las", cache_, fmt::format("--neighbours-search {} --neighbours 3", search));
        EXPECT_EQ(added.code, 0) << added.output;
        EXPECT_EQ(lucarne("verify " + cache_).code, 0) << search;
    }
}

class AppendTwice : public AppendCommand {
 protected:
    void SetUp() override {
        write(folder_ / "a.xyz", "0 0 0\n10 10 10\n");
        write(folder_ / "b.xyz", "1 2 3\n4 5 6\n");
        ASSERT_EQ(convert(folder_ / "a.xyz", cache_).code, 0);
        ASSERT_EQ(append(folder_ / "b.xyz", cache_).code, 0);
        ASSERT_EQ(header_of(cache_).points, 4u);
    }
};

TEST_F(AppendTwice, OfTheSameFileAddsItOnceAndSaysSo) {
    write(folder_ / "c.xyz", "7 7 7\n");
    const std::string before = bytes_of(cache_);
    for (const char* name : {"a.xyz", "b.xyz", "./b.xyz"}) {
        const auto again = append(folder_ / name, cache_);
        EXPECT_EQ(again.code, 0) << "so that a script can be run again: " << again.output;
        EXPECT_NE(again.output.find(" already, as scan "), std::string::npos) << again.output;
        EXPECT_EQ(bytes_of(cache_), before) << name;
    }
    const auto some =
        append((folder_ / "b.xyz") + " " + (folder_ / "c.xyz"), cache_, "--json " + (folder_ / "r.json"));
    EXPECT_EQ(some.code, 0) << some.output;
    EXPECT_NE(some.output.find("a.luc: 1 point"), std::string::npos) << some.output;
    EXPECT_EQ(header_of(cache_).points, 5u);
    EXPECT_NE(bytes_of(folder_ / "r.json").find("b.xyz"), std::string::npos);
}

TEST_F(AppendTwice, OfAFileThatHasChangedAddsItAndWarns) {
    write(folder_ / "b.xyz", "1 2 3\n4 5 6\n7 8 9\n");
    const auto again = append(folder_ / "b.xyz", cache_);
    EXPECT_EQ(again.code, 0) << again.output;
    EXPECT_NE(again.output.find("b.xyz: another state of this file is in "), std::string::npos)
        << again.output;
    EXPECT_NE(again.output.find("lucarne delete --scan 1 "), std::string::npos) << again.output;
    EXPECT_EQ(header_of(cache_).points, 7u);
}

TEST_F(AppendTwice, AddsAFileAgainThatWasDeletedMeanwhile) {
    ASSERT_EQ(lucarne("delete --scan 1 " + cache_).code, 0);
    const auto again = append(folder_ / "b.xyz", cache_);
    EXPECT_EQ(again.code, 0) << again.output;
    EXPECT_EQ(header_of(cache_).points, 4u);
}

TEST_F(AppendCommand, WarnsOfScansWithoutPointsAndNotOfTheCache) {
    write(folder_ / "a.xyz", "0 0 0\n10 10 10\n");
    write(folder_ / "b.xyz", "1 2 3\n");
    write(folder_ / "empty.ply",
          "ply\nformat ascii 1.0\nelement vertex 0\nproperty float x\nproperty float y\nproperty float "
          "z\nend_header\n");
    ASSERT_EQ(convert(folder_ / "a.xyz", cache_).code, 0);
    const auto added = append((folder_ / "b.xyz") + " " + (folder_ / "empty.ply"), cache_);
    EXPECT_EQ(added.code, 0) << added.output;
    EXPECT_EQ(added.output.find("a.luc: has no points"), std::string::npos) << added.output;
    EXPECT_NE(added.output.find("empty.ply: has no points"), std::string::npos) << added.output;
    const auto nothing = append(folder_ / "empty.ply", cache_);
    EXPECT_EQ(nothing.code, 3) << nothing.output;
    EXPECT_NE(nothing.output.find("empty.ply: has no points"), std::string::npos) << nothing.output;
}

TEST_F(AppendCommand, ManyTimesLeavesACacheOfAtMostTwiceWhatItHolds) {
    for (int i = 0; i < 20; ++i)
        ASSERT_EQ(lucarne(fmt::format("generate two-rooms --points 2k --seed {} -o {}", i,
                                      folder_ / fmt::format("{}.las", i)))
                      .code,
                  0);
    ASSERT_EQ(convert(folder_ / "0.las", cache_).code, 0);
    bool said = false;
    for (int i = 1; i < 20; ++i) {
        const auto added = append(folder_ / fmt::format("{}.las", i), cache_);
        ASSERT_EQ(added.code, 0) << added.output;
        said = said || added.output.find("as less than half of it was in use") != std::string::npos;
    }
    EXPECT_TRUE(said);
    const auto bytes = fs::file_size(cache_);
    ASSERT_EQ(lucarne("compact " + cache_).code, 0);
    EXPECT_LE(bytes, 2 * fs::file_size(cache_));
    EXPECT_EQ(lucarne("verify " + cache_).code, 0);
}

}  // namespace
}  // namespace lucarne::test
