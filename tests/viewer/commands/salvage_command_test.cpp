// Tests what the commands report about damaged files, and about data left out of good ones.
#include <filesystem>
#include <fstream>

#include <fmt/format.h>
#include <gmock/gmock.h>
#include <nlohmann/json.hpp>

#include "octree/cache/cache.h"
#include "tests/viewer/program.h"
#include "viewer/inputs/kept_cache.h"

namespace lucarne::viewer {
namespace {

namespace fs = std::filesystem;
using ::testing::HasSubstr;

class SalvageCommand : public ::testing::Test {
 protected:
    void SetUp() override {
        ASSERT_EQ(test::lucarne("generate cornell --points 3000 -o " + whole_).code, 0);
        ASSERT_EQ(test::lucarne("info --json " + json_ + " " + whole_).code, 0);
        points_ = json_of(json_)["points"];
        fs::remove(json_);
        fs::copy_file(whole_, cut_);
        fs::resize_file(cut_, fs::file_size(cut_) * 2 / 3);
    }
    static nlohmann::json json_of(const std::string& file) {
        std::ifstream in(file);
        return nlohmann::json::parse(in);
    }

    const test::TemporaryFolder folder_;
    const std::string whole_ = folder_ / "whole.las", cut_ = folder_ / "cut.las", cache_ = folder_ / "a.luc",
                      json_ = folder_ / "a.json";
    uint64_t points_ = 0;
};

TEST_F(SalvageCommand, ConvertSaysHowManyPointsItCouldSaveAndThenSavesThem) {
    const auto refused = test::lucarne("convert --normals none -o " + cache_ + " " + cut_);
    EXPECT_EQ(refused.code, 3);
    ASSERT_EQ(test::lucarne("info --salvage --overwrite --json " + json_ + " " + cut_).code, 0);
    const auto there = json_of(json_)["points"].get<uint64_t>();
    ASSERT_GT(there, 1000u);
    EXPECT_THAT(refused.output, HasSubstr(fmt::format("; {} points can be saved with --salvage", there)));
    EXPECT_FALSE(fs::exists(cache_));

    const auto saved = test::lucarne("convert --salvage --overwrite --normals none --json " + json_ + " -o " +
                                     cache_ + " " + cut_);
    EXPECT_EQ(saved.code, 0) << saved.output;
    const std::string lost = fmt::format("{} points that are not there", points_ - there);
    EXPECT_THAT(saved.output, HasSubstr("left out: " + lost));
    const auto cache = octree::open_cache(cache_);
    ASSERT_TRUE(cache) << cache.error().line();
    EXPECT_EQ((*cache)->header().points, there);
    EXPECT_EQ((*cache)->header().options, "--salvage");
    const auto report = json_of(json_);
    EXPECT_EQ(report["left_out"][0]["count"], points_ - there);
    EXPECT_EQ(report["inputs"][0]["points"], there);
    EXPECT_THAT(test::lucarne("info " + cache_).output,
                HasSubstr(fmt::format("\"count\":{}", points_ - there)));
}

TEST_F(SalvageCommand, OfSeveralInputsTheBrokenOneIsNamedWithWhatCouldBeSaved) {
    const auto done = test::lucarne("convert --normals none -o " + cache_ + " " + cut_ + " " + whole_);
    EXPECT_EQ(done.code, 3);
    EXPECT_THAT(done.output, HasSubstr("1 of 2 inputs are not in it"));
    EXPECT_THAT(done.output, HasSubstr("points can be saved with --salvage"));
    EXPECT_EQ(octree::open_cache(cache_).value()->header().points, points_);
}

TEST_F(SalvageCommand, InfoGoesOnBehindABrokenInputAndListsTheOthers) {
    const std::string twin = folder_ / "twin.las";
    fs::copy_file(whole_, twin);
    const auto done = test::lucarne("info --json " + json_ + " " + cut_ + " " + whole_ + " " + twin);
    EXPECT_EQ(done.code, 3);
    EXPECT_THAT(done.output, HasSubstr("1 of 3 inputs cannot be read"));
    auto info = json_of(json_);
    ASSERT_EQ(info.size(), 3u);
    EXPECT_EQ(info[2]["path"], cut_);
    EXPECT_THAT(info[2]["reason"].get<std::string>(), HasSubstr("is truncated"));
    info.erase(2);
    for (const auto& scan : info) {
        EXPECT_EQ(scan["points"], points_);
        EXPECT_EQ(scan["unit"], "m");
        EXPECT_LT(scan["min"][2], scan["max"][2]);
        EXPECT_TRUE(scan["left_out"].empty());
    }
}

TEST_F(SalvageCommand, InfoSaysWhatIsLeftOutAndWhy) {
    std::ofstream(folder_ / "a.ply") << "ply\nformat ascii 1.0\nelement vertex 3\nproperty float x\nproperty "
                                        "float y\nproperty float z\nelement edge 1\nproperty int vertex1\n"
                                        "property int vertex2\nend_header\n1 2 3\nnan 2 3\n4 5 6\n0 1\n";
    ASSERT_EQ(test::lucarne("info --json " + json_ + " " + (folder_ / "a.ply")).code, 0);
    const auto info = json_of(json_);
    EXPECT_EQ(info["points"], 2);
    EXPECT_EQ(info["min"], (nlohmann::json{1, 2, 3}));
    EXPECT_EQ(info["max"], (nlohmann::json{4, 5, 6}));
    EXPECT_EQ(info["left_out"],
              (nlohmann::json{{{"count", 1}, {"what", "entries of 'edge', which are not read"}},
                              {{"count", 1}, {"what", "points with a coordinate that is no number"}}}));
    ASSERT_EQ(test::lucarne("info --quick --overwrite --json " + json_ + " " + (folder_ / "a.ply")).code, 0);
    EXPECT_FALSE(json_of(json_).contains("min"));
}

TEST_F(SalvageCommand, ACacheOfOtherOptionsIsNotTakenForThatOfAScan) {
    ASSERT_EQ(test::lucarne("convert --normals none -o " + whole_ + ".luc " + whole_).code, 0);
    const auto scans = octree::open_cache(whole_ + ".luc").value()->header().scans;
    EXPECT_TRUE(KeptCache(scans).find());
    EXPECT_FALSE(KeptCache(scans, "--salvage").find());
    ASSERT_EQ(
        test::lucarne("convert --salvage --overwrite --normals none -o " + whole_ + ".luc " + whole_).code,
        0);
    EXPECT_FALSE(KeptCache(scans).find());
    EXPECT_TRUE(KeptCache(scans, "--salvage").find());
}

}  // namespace
}  // namespace lucarne::viewer
