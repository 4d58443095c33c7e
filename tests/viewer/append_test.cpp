// `lucarne convert --append` as a user runs it.
#include <filesystem>
#include <fstream>

#include <fmt/format.h>
#include <gtest/gtest.h>

#include "octree/cache.h"
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

}  // namespace
}  // namespace lucarne::test
