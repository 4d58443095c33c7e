// An engine that computes something in advance: its result is kept beside the cache, continued, and computed
// again when an input changes.
#include <filesystem>
#include <fstream>

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "gi/bake/bake_file.h"
#include "io/files/file.h"
#include "tests/added_engine/paint/mean_colour.h"
#include "tests/added_engine/paint/paint.h"
#include "tests/added_engine/run.h"
#include "tests/viewer/program.h"

namespace lucarne::viewer {
namespace {

using testing::HasSubstr;

class BakeTest : public testing::Test {
 protected:
    void SetUp() override {
        cache_ = test::make_cornell(folder_, "20k");
        place_ = cache_ + ".paint.bake";
        gi::paint_hooks().steps = 0;
    }
    void TearDown() override { ::unsetenv("XDG_CACHE_HOME"); }
    Result<void> prepare(const std::vector<std::string>& more = {}) {
        std::vector<std::string> words = {"prepare", cache_, "--engine", "paint"};
        words.insert(words.end(), more.begin(), more.end());
        gi::paint_hooks().steps = 0;
        return test::run(words);
    }
    /// Returns the colour of the picture's surfaces, which is the mean colour.
    glm::vec3 painted(const std::vector<std::string>& more = {}) const {
        std::vector<std::string> words = {"--pattern", "mean"};
        words.insert(words.end(), more.begin(), more.end());
        return test::brightest(cache_, folder_ / "out.exr", "paint", words);
    }
    Result<gi::BakeHeader> kept() const {
        LUCARNE_ASSIGN(const auto file, InputFile::open_shared(place_));
        return gi::read_bake_header(*file);
    }
    test::TemporaryFolder folder_;
    std::string cache_, place_;
};

TEST_F(BakeTest, IsComputedOnceAndKeptBesideTheCache) {
    ASSERT_TRUE(prepare());
    EXPECT_EQ(gi::paint_hooks().steps, gi::paint::kMeanSteps);
    const auto header = kept();
    ASSERT_TRUE(header) << header.error().line();
    EXPECT_EQ(header->engine, "paint");
    EXPECT_EQ(header->share, 1);
    ASSERT_TRUE(prepare());
    EXPECT_EQ(gi::paint_hooks().steps, 0u) << "it is read from the file";
    const glm::vec3 colour = painted();
    EXPECT_EQ(gi::paint_hooks().steps, 0u);
    EXPECT_GT(colour.x, .1f);
    EXPECT_LT(colour.x, 1);
}

TEST_F(BakeTest, APictureThatWaitsComputesAllOfIt) {
    const glm::vec3 colour = painted();
    EXPECT_EQ(gi::paint_hooks().steps, gi::paint::kMeanSteps);
    EXPECT_GT(colour.x, .1f);
    EXPECT_EQ(painted(), colour);
    EXPECT_EQ(gi::paint_hooks().steps, gi::paint::kMeanSteps);
}

TEST_F(BakeTest, OnlyWhatItDependsOnMakesItAgain) {
    const glm::vec3 colour = painted();
    gi::paint_hooks().steps = 0;
    EXPECT_NEAR(painted({"--paint-gain", "2"}).x, 2 * colour.x, 1e-3f);
    EXPECT_EQ(gi::paint_hooks().steps, 0u) << "an option of the picture";
    painted({"--mood", "evening"});
    EXPECT_EQ(gi::paint_hooks().steps, 0u) << "light";
    EXPECT_NEAR(painted({"--mean-scale", "2"}).x, 2 * colour.x, 1e-3f);
    EXPECT_EQ(gi::paint_hooks().steps, gi::paint::kMeanSteps) << "an option of the precomputation";
    painted({"--mean-scale", "2", "--colour", "elevation"});
    EXPECT_EQ(gi::paint_hooks().steps, 2 * gi::paint::kMeanSteps) << "the points' colours";
}

TEST_F(BakeTest, DamagedFilesAreComputedAgain) {
    const glm::vec3 colour = painted();
    const std::string whole = test::bytes_of(place_);
    for (const size_t at : {size_t{0}, size_t{9}, size_t{30}, size_t{120}, whole.size() - 1}) {
        std::string wrong = whole;
        wrong[at] = static_cast<char>(wrong[at] ^ 0x55);
        std::ofstream(place_, std::ios::binary) << wrong;
        gi::paint_hooks().steps = 0;
        EXPECT_EQ(painted(), colour);
        EXPECT_EQ(gi::paint_hooks().steps, gi::paint::kMeanSteps) << at;
        EXPECT_EQ(test::bytes_of(place_), whole) << "the same bytes on every run";
    }
    std::ofstream(place_, std::ios::binary) << whole.substr(0, whole.size() / 2);
    EXPECT_EQ(painted(), colour);
    EXPECT_EQ(test::bytes_of(place_), whole);
}

TEST_F(BakeTest, SectionsThatTheEngineRefusesAreComputedAgain) {
    const glm::vec3 colour = painted();
    const std::string whole = test::bytes_of(place_);
    const auto file = InputFile::open_shared(place_);
    ASSERT_TRUE(file);
    auto bake = gi::read_bake(**file, 1 << 20);
    ASSERT_TRUE(bake) << bake.error().line();
    bake->sections.at("sums").pop_back();
    ASSERT_TRUE(gi::write_bake(place_, *bake));
    EXPECT_EQ(painted(), colour);
    EXPECT_EQ(test::bytes_of(place_), whole);
}

TEST_F(BakeTest, EnginesThatPrecomputeNothingSaySo) {
    const auto done = test::run({"prepare", cache_, "--engine", "vpl"});
    ASSERT_FALSE(done);
    EXPECT_EQ(done.error().kind, ErrorKind::arguments);
    EXPECT_THAT(done.error().line(), HasSubstr("vpl computes nothing in advance"));
}

TEST_F(BakeTest, WithoutAPlaceThePictureIsMadeAndPrepareFails) {
    const glm::vec3 colour = painted();
    std::filesystem::remove(place_);
    std::filesystem::create_directory(place_);  // cannot be replaced by a file
    const std::string nothing = folder_ / "nothing";
    std::ofstream(nothing) << "a file is no folder";
    ::setenv("XDG_CACHE_HOME", nothing.c_str(), 1);
    EXPECT_EQ(painted(), colour);
    const auto done = prepare();
    ASSERT_FALSE(done);
    EXPECT_THAT(done.error().line(), HasSubstr("no place"));
}

}  // namespace
}  // namespace lucarne::viewer
