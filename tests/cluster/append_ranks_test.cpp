// Several ranks append the same bytes as one process, and what fails leaves the cache as it was.
#include <filesystem>
#include <fstream>
#include <memory>
#include <string>
#include <vector>

#include <gtest/gtest.h>

#include "tests/cluster/rank_faults.h"
#include "tests/cluster/ranks.h"
#include "tests/cluster/scans.h"

namespace lucarne {
namespace {

using test::lucarne;
using test::on_ranks;
using test::Outcome;
using test::times;

/// The scans are made once for all tests.
class SameBytesAppended : public testing::Test {
 protected:
    static void SetUpTestSuite() {
        folder_ = std::make_unique<test::TemporaryFolder>();
        test::make_scans(*folder_);
        test::generate(*folder_, "nave", "150k", "nave.laz", "--stations 2");
        test::generate(*folder_, "nave", "40k", "again.laz", "--stations 1 --seed 7");
        std::ofstream few(*folder_ / "few.xyz");
        for (int i = 0; i < 200; ++i) few << i * .01 << ' ' << i % 7 * .1 << " 0\n";
    }
    static void TearDownTestSuite() { folder_.reset(); }
    void SetUp() override { LUCARNE_NEEDS_RANKS(); }

    static std::string inputs(const std::vector<std::string>& names) {
        std::string all;
        for (const std::string& name : names) all += *folder_ / name + " ";
        return all;
    }
    /// Makes a cache of some scans, and appends others with one process and on 1, 2, 4 and 7 ranks. 48M makes
    /// many chunks of few points. Returns what the process printed.
    static std::string expect_same(const std::vector<std::string>& first, const std::string& options,
                                   const std::vector<std::string>& then) {
        const std::string before = *folder_ / "before.luc", alone = *folder_ / "alone.luc",
                          together = *folder_ / "together.luc";
        const Outcome made =
            lucarne("convert " + inputs(first) + options + " --memory 48M --overwrite -o " + before);
        EXPECT_EQ(made.code, 0) << made.output;
        const auto fresh = std::filesystem::copy_options::overwrite_existing;
        std::filesystem::copy_file(before, alone, fresh);
        const std::string what = "convert --append " + inputs(then) + " --memory 48M -o ";
        const Outcome one = lucarne(what + alone);
        EXPECT_EQ(one.code, 0) << one.output;
        const std::string expected = test::bytes_of(alone);
        EXPECT_FALSE(expected == test::bytes_of(before));
        for (const int ranks : {1, 2, 4, 7}) {
            std::filesystem::copy_file(before, together, fresh);
            const Outcome several = on_ranks(ranks, what + together);
            EXPECT_EQ(several.code, 0) << several.output;
            EXPECT_TRUE(test::bytes_of(together) == expected) << ranks << " ranks, " << options;
            EXPECT_EQ(lucarne("verify " + together).code, 0);
        }
        return one.output;
    }

    static std::unique_ptr<test::TemporaryFolder> folder_;
};
std::unique_ptr<test::TemporaryFolder> SameBytesAppended::folder_;

TEST_F(SameBytesAppended, WithNormalsOverTheSamePlaces) {
    expect_same({"nave.laz"}, "", {"again.laz", "survey.las"});
}

TEST_F(SameBytesAppended, BesideNodesThatStay) {
    const std::string said = expect_same({"nave.laz", "survey.las"}, "", {"cornell.las"});
    EXPECT_EQ(said.find(" 0 of "), std::string::npos) << said;
    EXPECT_NE(said.find("nodes stayed"), std::string::npos) << said;
}

TEST_F(SameBytesAppended, BesideNodesThatStayInAnotherLayout) {
    const std::string said = expect_same({"nave.laz"}, "--no-fill", {"rooms.las", "statue.ply"});
    EXPECT_EQ(said.find(" 0 of "), std::string::npos) << said;
}

TEST_F(SameBytesAppended, WithoutNormals) {
    expect_same({"survey.las", "rows.xyz"}, "--normals none", {"nave.laz", "cornell.las", "rooms.las"});
}

TEST_F(SameBytesAppended, WithKeptNormals) {
    expect_same({"rooms.las"}, "--normals keep", {"survey.las", "statue.ply"});
}

TEST_F(SameBytesAppended, OfAPlaceWithMorePointsThanAChunk) {
    expect_same({"cornell.las"}, "", {"heap.xyz"});
}

TEST_F(SameBytesAppended, OfSoFewPointsThatOneNodeHasThemAll) {
    expect_same({"few.xyz"}, "", {"statue.ply"});
}

TEST_F(SameBytesAppended, OfOneFileOfWhichEachRankReadsAPart) {
    test::make_silent(*folder_, "silent.las", "60k");
    expect_same({"cornell.las"}, "", {"silent.las"});
}

TEST_F(SameBytesAppended, TwiceIsLeftOutWithOneWarning) {
    const std::string cache = *folder_ / "twice.luc";
    ASSERT_EQ(lucarne("convert " + inputs({"rows.xyz", "cornell.las"}) + "-o " + cache).code, 0);
    const std::string before = test::bytes_of(cache);
    const Outcome again = on_ranks(3, "convert --append " + inputs({"cornell.las"}) + "-o " + cache);
    EXPECT_EQ(again.code, 0) << again.output;
    EXPECT_EQ(times(again.output, "it is left out"), 1u) << again.output;
    EXPECT_TRUE(test::bytes_of(cache) == before);
}

/// Appends two scans to a cache of another one.
class AppendRankFaults : public test::RankFaults {
 protected:
    void SetUp() override {
        RankFaults::SetUp();
        if (IsSkipped()) return;
        const std::string scan = folder_ / "nave.laz";
        ASSERT_EQ(lucarne("generate nave --points 20k -o " + scan).code, 0);
        for (const char* scene : {"cornell", "house"})  // smaller ones, because every test appends them often
            ASSERT_EQ(lucarne(std::string("generate ") + scene + " --points 12k --overwrite -o " +
                              folder_ / (std::string(scene) + ".las"))
                          .code,
                      0);
        const Outcome made = lucarne("convert " + scan + test::kSmall + output());
        ASSERT_EQ(made.code, 0) << made.output;
        before_ = test::bytes_of(output());
    }
    void start_anew() const { std::ofstream(output(), std::ios::binary) << before_; }
    /// Returns which of a rank's calls are writes; MPI makes others when it starts.
    std::vector<size_t> writes_of(int rank) const {
        start_anew();
        const std::string trace = folder_ / "calls";
        const Outcome done = with_fault(rank, "trace:" + trace, "--append");
        EXPECT_EQ(done.code, 0) << done.output;
        std::vector<size_t> writes;
        std::ifstream lines(trace);
        std::string name;
        for (size_t call = 1; std::getline(lines, name); ++call)
            if (name == "pwrite") writes.push_back(call);
        return writes;
    }
    std::string before_;
};

TEST_F(AppendRankFaults, AKilledRankLeavesTheOldState) {
    for (const int rank : {0, 1}) {
        const auto writes = writes_of(rank);
        ASSERT_GT(writes.size(), 8u);
        for (const size_t at : {writes[0], writes[writes.size() / 3], writes[writes.size() * 2 / 3]}) {
            start_anew();
            const Outcome killed = with_fault(rank, "kill:" + std::to_string(at), "--append");
            EXPECT_NE(killed.code, 0) << killed.output;
            EXPECT_NE(killed.output.find("signal 9"), std::string::npos) << killed.output;
            // What was written behind it does no harm.
            EXPECT_TRUE(test::bytes_of(output()).starts_with(before_)) << "rank " << rank << ", " << at;
            const Outcome sound = lucarne("verify " + output());
            EXPECT_EQ(sound.code, 0) << sound.output;
        }
        // The next append cuts it off.
        EXPECT_EQ(without_fault("--append", 2).code, 0);
        EXPECT_EQ(lucarne("verify " + output()).code, 0);
    }
}

TEST_F(AppendRankFaults, AKillAroundTheSwitchLeavesASoundCache) {
    start_anew();
    EXPECT_EQ(without_fault("--append", 3).code, 0);
    const std::string appended = test::bytes_of(output());
    for (const int sync : {1, 2}) {  // before the superblock is written, and behind it
        start_anew();
        const Outcome killed = with_fault(0, "kill-sync:" + std::to_string(sync), "--append");
        EXPECT_NE(killed.output.find("signal 9"), std::string::npos) << killed.output;
        EXPECT_EQ(lucarne("verify " + output()).code, 0);
        const std::string after = test::bytes_of(output());
        EXPECT_TRUE(sync == 1 ? after.starts_with(before_) : after == appended) << sync;
    }
}

TEST_F(AppendRankFaults, AFullDiskOfOneRankIsTheErrorOfAllAndLeavesTheOldState) {
    for (const int rank : {0, 1}) {
        const auto writes = writes_of(rank);
        ASSERT_GT(writes.size(), 8u);
        start_anew();
        const Outcome full =
            with_fault(rank, "full:" + std::to_string(writes[writes.size() / 2]), "--append");
        EXPECT_EQ(full.code, 1) << full.output;
        EXPECT_EQ(times(full.output, "No space left on device"), 3u) << full.output;
        // The fault of rank 0 is also that it cannot cut off what it wrote behind them.
        const std::string after = test::bytes_of(output());
        EXPECT_TRUE(rank == 0 ? after.starts_with(before_) : after == before_) << full.output;
        EXPECT_EQ(lucarne("verify " + output()).code, 0);
        for (const char* place : {"out", "temp"})
            for (const auto& entry : std::filesystem::directory_iterator(folder_ / place)) {
                EXPECT_EQ(entry.path(), output()) << "was left";
            }
    }
}

TEST_F(AppendRankFaults, ABrokenInputIsSkippedAsByOneProcess) {
    const std::string broken = folder_ / "broken.las", bytes = test::bytes_of(folder_ / "house.las");
    std::ofstream(broken, std::ios::binary) << bytes.substr(0, bytes.size() / 2);
    const std::string one_cache = folder_ / "one.luc", what = "convert --append " + inputs() + " " + broken;
    std::filesystem::copy_file(output(), one_cache);
    const Outcome one = lucarne(what + test::kSmall + one_cache),
                  several = on_ranks(3, what + test::kSmall + output());
    EXPECT_EQ(one.code, 3) << one.output;
    EXPECT_EQ(several.code, 3) << several.output;
    EXPECT_TRUE(test::bytes_of(one_cache) == test::bytes_of(output()));
    EXPECT_FALSE(test::bytes_of(output()) == before_);
}

TEST_F(AppendRankFaults, RanksThatSeeAnotherStateOfTheCacheAreRefused) {
    const std::string script = folder_ / "rank.sh", other = folder_ / "other";
    std::filesystem::create_directory(other);
    ASSERT_EQ(lucarne("convert " + folder_ / "house.las" + " -o " + other + "/a.luc").code, 0);
    std::ofstream(script) << "#!/bin/sh\nfolder=" + folder_ / "out" +
                                 "; if [ \"$OMPI_COMM_WORLD_RANK\" = 1 ]; then folder=" + other +
                                 "; fi\ncd $folder\nexec " + LUCARNE_BINARY + " convert --append " +
                                 folder_ / "cornell.las" + test::kSmall + "a.luc\n";
    const Outcome seen = test::shell(test::mpirun(2) + "sh " + script);
    EXPECT_EQ(seen.code, 1) << seen.output;
    EXPECT_EQ(times(seen.output, "rank 1 has another one than rank 0"), 2u) << seen.output;
    EXPECT_TRUE(test::bytes_of(output()) == before_);
}

}  // namespace
}  // namespace lucarne
