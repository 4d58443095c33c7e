// Many inputs at once: folders, and broken files among sound ones.
#include <filesystem>
#include <fstream>

#include <fmt/format.h>
#include <gtest/gtest.h>

#include "octree/cache.h"
#include "tests/viewer/program.h"

namespace lucarne::viewer {
namespace {

namespace fs = std::filesystem;

class ConvertInputs : public ::testing::Test {
 protected:
    void SetUp() override {
        fs::create_directories(scans_ / "below");
        for (int i = 0; i < 3; ++i)
            ASSERT_EQ(
                test::lucarne(fmt::format("generate cornell --points 3000 --seed {} -o {}", i, scan(i))).code,
                0);
        std::ofstream(scans_ / "notes.md") << "not a scan";
    }
    std::string scan(int i) const {
        return (scans_ / (i == 2 ? "below" : "") / fmt::format("scan{}.las", i)).string();
    }
    test::Outcome convert(const std::string& what) const {
        return test::lucarne("convert -o " + cache_ + " " + what);
    }
    void cut_short(int i) const { fs::resize_file(scan(i), fs::file_size(scan(i)) / 2); }

    const test::TemporaryFolder folder_;
    const fs::path scans_ = folder_ / "scans";
    const std::string cache_ = folder_ / "all.luc";
};

TEST_F(ConvertInputs, AFolderStandsForTheScansInItAndBelow) {
    const auto done = convert(scans_.string() + " --normals none");
    ASSERT_EQ(done.code, 0) << done.output;
    EXPECT_EQ(octree::open_cache(cache_).value()->header().scans.size(), 3u);
}

TEST_F(ConvertInputs, ABrokenFileOfManyStopsOnlyItselfAndIsNamed) {
    cut_short(1);
    const auto done = convert(scans_.string() + " --normals none");
    EXPECT_EQ(done.code, 3) << done.output;
    EXPECT_NE(done.output.find("1 of 3 inputs are not in it"), std::string::npos) << done.output;
    EXPECT_NE(done.output.find(scan(1) + ": is truncated"), std::string::npos) << done.output;
    const auto cache = octree::open_cache(cache_);
    ASSERT_TRUE(cache) << cache.error().line();
    EXPECT_EQ((*cache)->header().scans.size(), 2u);
}

TEST_F(ConvertInputs, ABrokenFileAloneAndAFolderOfNoneFail) {
    cut_short(0);
    EXPECT_EQ(convert(scan(0)).code, 3);
    EXPECT_FALSE(fs::exists(cache_));
    fs::create_directories(folder_ / "empty");
    EXPECT_EQ(convert(folder_ / "empty").code, 3);
    for (int i = 1; i < 3; ++i) cut_short(i);
    EXPECT_EQ(convert(scans_.string()).code, 3);
    EXPECT_FALSE(fs::exists(cache_));
}

}  // namespace
}  // namespace lucarne::viewer
