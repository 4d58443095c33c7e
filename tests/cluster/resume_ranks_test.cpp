// A conversion by several ranks goes on after it was killed, to the same bytes.
#include <algorithm>
#include <chrono>
#include <filesystem>
#include <fstream>
#include <string>
#include <vector>

#include <fmt/format.h>
#include <gtest/gtest.h>

#include "tests/cluster/rank_faults.h"

namespace lucarne {
namespace {

namespace fs = std::filesystem;

using test::kSmall;
using test::lucarne;
using test::on_ranks;
using test::Outcome;

class ResumedRanks : public test::RankFaults {
 protected:
    void SetUp() override {
        RankFaults::SetUp();
        if (!IsSkipped()) convert_alone();
    }
    void convert_alone() {
        const Outcome one = lucarne("convert " + inputs() + kSmall + folder_ / "one.luc --overwrite");
        ASSERT_EQ(one.code, 0) << one.output;
        expected_ = test::bytes_of(folder_ / "one.luc");
    }
    /// Returns what rank 1 of several does to files, or the only one.
    std::vector<std::string> calls(int count) {
        const std::string trace = folder_ / ("trace" + std::to_string(count));
        if (!fs::exists(trace)) {
            const Outcome traced = with_fault(count > 1 ? 1 : 0, "trace:" + trace, "", count);
            EXPECT_EQ(traced.code, 0) << traced.output;
            fs::remove(output());
        }
        std::vector<std::string> names;
        std::ifstream lines(trace);
        for (std::string name; std::getline(lines, name);) names.push_back(name);
        return names;
    }
    /// Kills rank 1 of three, or the only one, in the last stage: a rank syncs the cache when it has written
    /// its payloads, which it builds in the last stage.
    void interrupt(int count = 3) {
        const int rank = count > 1 ? 1 : 0;
        auto syncs = std::ranges::count(calls(count), "fsync");
        if (count == 1) syncs = 1;  // it syncs the folder as well, when the cache has its name
        ASSERT_GT(syncs, 0);
        const Outcome killed = with_fault(rank, "kill-sync:" + std::to_string(syncs), "", count);
        ASSERT_NE(killed.code, 0) << killed.output;
        ASSERT_FALSE(fs::exists(output()));
    }
    /// Goes on with so many ranks; 0: without MPI.
    Outcome resume(int count) const {
        const std::string what = convert() + " --resume";
        return count > 0 ? on_ranks(count, what) : lucarne(what);
    }
    /// `kept`: what an earlier conversion finished, empty if this one begins anew. Expects that nothing is
    /// left of the interrupted ones.
    void expect_resumed(const Outcome& resumed, const std::string& kept) {
        ASSERT_EQ(resumed.code, 0) << resumed.output;
        EXPECT_NE(resumed.output.find(kept), std::string::npos) << resumed.output;
        EXPECT_TRUE(test::bytes_of(output()) == expected_) << resumed.output;
        for (const auto& entry : fs::recursive_directory_iterator(folder_ / "temp"))
            EXPECT_TRUE(entry.path().parent_path() == folder_ / "temp" && !temp_of_rank_.empty())
                << entry.path() << " was left\n"
                << resumed.output;
        fs::remove(output());
    }
    /// The folders in --temp, in the order of ranks.
    std::vector<fs::path> folders() const {
        std::vector<fs::path> found;
        for (const auto& entry : fs::directory_iterator(folder_ / "temp")) found.push_back(entry.path());
        std::ranges::sort(found);
        return found;
    }
    /// The work folders that a conversion has left, each with its points.
    std::vector<fs::path> left() const {
        std::vector<fs::path> found = folders();
        std::erase_if(found, [](const fs::path& folder) { return !fs::exists(folder / "points"); });
        return found;
    }
    std::string expected_;
};

TEST_F(ResumedRanks, GoOnWithTheSameNumber) {
    interrupt();
    expect_resumed(resume(3), "going on after 'normals'");
}

TEST_F(ResumedRanks, GoOnWithAnotherNumber) {
    for (const int count : {2, 4, 1, 0}) {
        interrupt();
        ASSERT_EQ(left().size(), 3u);
        expect_resumed(resume(count), "going on after 'normals' of the interrupted conversion by 3 ranks");
    }
}

TEST_F(ResumedRanks, GoOnWithWhatOneProcessLeft) {
    interrupt(1);
    expect_resumed(resume(3), "going on after 'normals' of the interrupted conversion by one process");
}

TEST_F(ResumedRanks, GoOnAgainWhenTheyAreKilledWhileTheyTakeOver) {
    const std::string counted = folder_ / "calls";
    interrupt();
    ASSERT_EQ(with_fault(1, "count:" + counted, "--resume", 2).code, 0);
    fs::remove(output());
    const int calls = std::stoi(test::bytes_of(counted));
    ASSERT_GT(calls, 10);
    for (const int at : {calls / 4, calls / 2}) {
        interrupt();
        EXPECT_NE(with_fault(1, "kill:" + std::to_string(at), "--resume", 2).code, 0);
        expect_resumed(resume(at == calls / 4 ? 2 : 4), "going on after");
    }
}

TEST_F(ResumedRanks, AreNotMissedIfTheyWereKilledWhileTheyRemovedTheirFolders) {
    std::vector<std::string> ending = calls(3);
    const auto syncs = std::ranges::count(ending, "fsync");
    ending.erase(ending.begin(), std::find(ending.rbegin(), ending.rend(), "fsync").base());
    const auto first_removal = std::ranges::find(ending, "unlinkat") - ending.begin();
    ASSERT_GT(first_removal, 0);
    ASSERT_LT(first_removal + 1, std::ssize(ending));
    for (const ptrdiff_t at : {ptrdiff_t{0}, first_removal, first_removal + 1}) {
        const Outcome killed = with_fault(1, fmt::format("kill-sync:{}:{}", syncs, at + 1), "--overwrite");
        ASSERT_NE(killed.code, 0) << killed.output;
        // When a rank removes its files, the others may have finished with theirs.
        const std::string own = ".1-of-3.";
        for (const fs::path& folder : folders())
            if (at >= first_removal && folder.string().find(own) == std::string::npos) fs::remove_all(folder);
        const Outcome resumed = on_ranks(at % 2 == 0 ? 3 : 2, convert() + " --resume --overwrite");
        expect_resumed(resumed, "");
        EXPECT_EQ(resumed.output.find("damaged"), std::string::npos) << resumed.output;
    }
}

TEST_F(ResumedRanks, RefuseToGoOnWithoutThePartOfOne) {
    interrupt();
    std::vector<fs::path> folders = left();
    ASSERT_EQ(folders.size(), 3u);
    const auto of_rank_1 = std::ranges::find_if(
        folders, [](const fs::path& folder) { return folder.string().find(".1-of-3") != std::string::npos; });
    ASSERT_NE(of_rank_1, folders.end());
    const fs::path away = folder_ / "away";
    fs::rename(*of_rank_1, away);
    for (const int count : {3, 2, 0}) {
        const Outcome refused = resume(count);
        EXPECT_EQ(refused.code, 1) << refused.output;
        EXPECT_NE(refused.output.find("by 3 ranks, the work folder of rank 1 is on no machine"),
                  std::string::npos)
            << refused.output;
        EXPECT_EQ(left().size(), 2u) << refused.output;
    }
    fs::rename(away, *of_rank_1);
    expect_resumed(resume(3), "going on after 'normals'");
    interrupt();
    fs::remove_all(left()[1]);
    expect_resumed(on_ranks(3, convert()), "removed ");  // without --resume
}

TEST_F(ResumedRanks, GoOnOnOtherMachines) {
    temp_of_rank_ = "/$OMPI_COMM_WORLD_RANK";
    const auto temp = [&](int rank) { return folder_ / "temp" + "/" + std::to_string(rank); };
    for (int rank = 0; rank < 3; ++rank) fs::create_directory(temp(rank));
    // All run elsewhere, or two have changed places.
    for (const bool all : {true, false}) {
        interrupt();
        fs::rename(temp(0), temp(9));
        fs::rename(temp(1), temp(0));
        if (all) fs::rename(temp(2), temp(1));
        fs::rename(temp(9), temp(all ? 2 : 1));
        expect_resumed(without_fault("--resume", 3), "going on after 'normals'");
    }
}

TEST_F(ResumedRanks, GoOnAgainOnOtherMachinesWhenTheyAreKilledWhileTheyTakeOver) {
    temp_of_rank_ = "/$OMPI_COMM_WORLD_RANK";
    const auto temp = [&](int rank) { return folder_ / "temp" + "/" + std::to_string(rank); };
    for (int rank = 0; rank < 3; ++rank) fs::create_directory(temp(rank));
    const auto interrupt_and_swap = [&] {
        interrupt();
        fs::rename(temp(0), temp(9));
        fs::rename(temp(1), temp(0));
        fs::rename(temp(9), temp(1));
    };
    interrupt_and_swap();
    const std::string counted = folder_ / "calls";
    ASSERT_EQ(with_fault(2, "count:" + counted, "--resume", 3).code, 0);
    fs::remove(output());
    const int calls = std::stoi(test::bytes_of(counted));
    ASSERT_GT(calls, 10);
    // Rank 2 had its part already: it may hold its old and its new one.
    for (const int at : {calls / 2, calls * 2 / 3}) {
        interrupt_and_swap();
        EXPECT_NE(with_fault(2, "kill:" + std::to_string(at), "--resume", 3).code, 0);
        expect_resumed(without_fault("--resume", 3), "going on after");
    }
}

TEST_F(ResumedRanks, RemoveWorkFoldersThatWereBeingMadeOrRemoved) {
    interrupt();
    const std::vector<fs::path> folders = left();
    ASSERT_EQ(folders.size(), 3u);
    fs::remove(folders[0] / "points");
    fs::remove(folders[0] / "normals");
    fs::resize_file(folders[0] / "journal", 0);
    for (size_t i = 1; i < 3; ++i) {
        fs::remove_all(folders[i]);
        fs::create_directory(folders[i]);
    }
    expect_resumed(resume(2), "");
}

TEST_F(ResumedRanks, BeginAnewWhereAFileIsDamaged) {
    for (const int count : {3, 2}) {
        interrupt();
        ASSERT_EQ(left().size(), 3u);
        std::fstream(left()[0] / "points", std::ios::binary | std::ios::in | std::ios::out) << "other bytes";
        expect_resumed(resume(count),
                       count == 3 ? "have lost what stage 'chunk' made" : "are lost or damaged");
    }
}

TEST_F(ResumedRanks, RefuseToGoOnWhenAnInputHasChanged) {
    interrupt();
    fs::last_write_time(folder_ / "house.las", fs::file_time_type::clock::now() + std::chrono::hours(1));
    for (const int count : {3, 2, 0}) {
        const Outcome refused = resume(count);
        EXPECT_EQ(refused.code, 1) << refused.output;
        EXPECT_NE(refused.output.find("has stages of another conversion: '" + folder_ / "house.las"),
                  std::string::npos)
            << refused.output;
        EXPECT_EQ(left().size(), 3u) << refused.output;
    }
    convert_alone();
    expect_resumed(on_ranks(2, convert()), "removed ");  // without --resume
}

TEST_F(ResumedRanks, RemoveWhatOthersLeftIfTheyAreNotToGoOn) {
    interrupt();
    const Outcome again = on_ranks(2, convert());
    expect_resumed(again, "removed ");
}

}  // namespace
}  // namespace lucarne
