// Several ranks write the same bytes as one process.
#include <filesystem>
#include <fstream>
#include <memory>
#include <string>
#include <vector>

#include <gtest/gtest.h>

#include "tests/cluster/ranks.h"
#include "tests/cluster/scans.h"

namespace lucarne {
namespace {

using test::lucarne;
using test::on_ranks;
using test::Outcome;

/// The scans are made once for all tests.
class SameBytes : public testing::Test {
 protected:
    static void SetUpTestSuite() {
        folder_ = std::make_unique<test::TemporaryFolder>();
        test::make_scans(*folder_);
        test::generate(*folder_, "nave", "60k", "nave.laz", "--stations 2");
        test::generate(*folder_, "house", "30k", "house.ply");
        std::ofstream(*folder_ / "empty.xyz") << "";
    }
    static void TearDownTestSuite() { folder_.reset(); }
    void SetUp() override { LUCARNE_NEEDS_RANKS(); }

    static std::string inputs(const std::vector<std::string>& names) {
        std::string all;
        for (const std::string& name : names) all += *folder_ / name + " ";
        return all;
    }
    /// Converts with one process and on 1, 2, 4 and 7 ranks. 48M makes many chunks of few points.
    static void expect_same(const std::vector<std::string>& names, const std::string& options) {
        const std::string alone = *folder_ / "alone.luc", together = *folder_ / "together.luc";
        const std::string what = "convert " + inputs(names) + options + " --memory 48M --overwrite -o ";
        const Outcome one = lucarne(what + alone);
        ASSERT_EQ(one.code, 0) << one.output;
        const std::string expected = test::bytes_of(alone);
        ASSERT_GT(expected.size(), 1000u);
        for (const int ranks : {1, 2, 4, 7}) {
            const Outcome several = on_ranks(ranks, what + together);
            ASSERT_EQ(several.code, 0) << several.output;
            const bool exchanged =
                several.output.find(std::to_string(ranks) + " ranks exchanged") != std::string::npos;
            EXPECT_EQ(exchanged, ranks > 1) << several.output;
            EXPECT_TRUE(test::bytes_of(together) == expected) << ranks << " ranks, " << options;
        }
    }

    static std::unique_ptr<test::TemporaryFolder> folder_;
};
std::unique_ptr<test::TemporaryFolder> SameBytes::folder_;

TEST_F(SameBytes, OfTilesInSeveralFormatsWithoutNormals) {
    expect_same({"nave.laz", "house.ply", "survey.las", "rows.xyz"}, "--normals none");
}

TEST_F(SameBytes, OfManySmallTilesAndOneLargeOne) {
    expect_same({"statue.ply", "survey.las", "cornell.las", "rows.xyz", "rooms.las"}, "--normals none");
}

TEST_F(SameBytes, OfFewerTilesThanRanks) {
    expect_same({"survey.las"}, "--normals none");
}

TEST_F(SameBytes, OfAPlaceWithMorePointsThanAChunk) {
    expect_same({"heap.xyz", "cornell.las"}, "--normals none");
}

TEST_F(SameBytes, WithNormalsHolesAndColours) {
    expect_same({"nave.laz", "survey.las", "rooms.las", "house.ply"}, "");
}

TEST_F(SameBytes, WithNormalsOfOneTileWithStations) {
    expect_same({"nave.laz"}, "--no-fill");
}

TEST_F(SameBytes, OfOneFileOfWhichEachRankReadsAPart) {
    test::make_silent(*folder_, "silent.las", "60k");
    expect_same({"silent.las"}, "");
    const Outcome two = on_ranks(
        2, "convert " + inputs({"silent.las"}) + "--memory 48M --overwrite -o " + *folder_ / "together.luc");
    EXPECT_NE(two.output.find("reading: 30k points"), std::string::npos) << "by rank 0\n" << two.output;
    EXPECT_NE(two.output.find("4 stations estimated"), std::string::npos) << two.output;
}

TEST_F(SameBytes, OfALargeCompressedFileBetweenSmallOnes) {
    test::make_silent(*folder_, "silent.laz", "220k");
    expect_same({"statue.ply", "silent.laz", "cornell.las"}, "--no-fill");
}

TEST_F(SameBytes, WhereEachRankSeesOnlyItsShareOfTheFiles) {
    const test::TemporaryFolder views;  // a folder with one file for each rank, and one with both
    const std::vector<std::string> names = {"survey.las", "nave.laz"};
    for (const char* view : {"0", "1", "both"}) std::filesystem::create_directory(views / view);
    for (size_t i = 0; i < 2; ++i)
        for (const std::string& view : {std::to_string(i), std::string("both")})
            std::filesystem::create_hard_link(*folder_ / names[i], views / view + "/" + names[i]);
    const std::string what = std::string("exec ") + LUCARNE_BINARY +
                             " convert survey.las nave.laz --normals none --memory 48M --overwrite -o ";
    const Outcome one = test::shell("cd " + views / "both" + " && " + what + *folder_ / "alone.luc");
    ASSERT_EQ(one.code, 0) << one.output;
    const std::string script = views / "rank.sh";
    std::ofstream(script) << "cd " << views / "$OMPI_COMM_WORLD_RANK"
                          << " && " << what << *folder_ / "together.luc"
                          << "\n";
    const Outcome two = test::shell(test::mpirun(2) + "sh " + script);
    ASSERT_EQ(two.code, 0) << two.output;
    EXPECT_TRUE(test::bytes_of(*folder_ / "alone.luc") == test::bytes_of(*folder_ / "together.luc"));
}

TEST_F(SameBytes, WithKeptNormals) {
    expect_same({"rooms.las"}, "--normals keep");
}

}  // namespace
}  // namespace lucarne
