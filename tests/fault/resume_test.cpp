// Conversions that are killed, run out of space or lose unsynced data, and are resumed.
#include <algorithm>
#include <string>

#include <gtest/gtest.h>

#include "io/core/random.h"
#include "io/files/update_file.h"
#include "tests/fault/run_lucarne.h"
#include "tests/io/io_testing.h"

namespace lucarne {
namespace {

using io::testing::read_bytes;
using io::testing::write_bytes;
using test::lucarne;
using test::lucarne_with_fault;
using test::Outcome;
using test::quoted;

namespace fs = std::filesystem;

constexpr const char* kLeft = ".lucarne-work";

/// A scan, its expected cache, and the number of calls that change files in its conversion.
class Conversion : public testing::Test {
 protected:
    void SetUp() override {
        ASSERT_EQ(lucarne("generate two-rooms --points 30k -o " + quoted(scan_)).code, 0);
        const auto calls = test::traced_calls(folder_ / "calls", convert(""));
        calls_ = calls.size();
        last_write_ = static_cast<uint64_t>(std::ranges::find(calls, "fsync") - calls.begin());
        reference_ = read_bytes(cache_);
        fs::remove(cache_);
        ASSERT_GT(calls_, 10u);
        ASSERT_TRUE(leftovers().empty());
    }
    /// The memory is so small that there are several chunks.
    std::string convert(const std::string& options) const {
        return "convert --memory 48M " + options + " " + quoted(scan_) + " -o " + quoted(cache_);
    }
    std::vector<fs::path> leftovers() const {
        std::vector<fs::path> found;
        for (const auto& entry : fs::directory_iterator(folder_.path()))
            if (entry.path().string().ends_with(kLeft)) found.push_back(entry.path());
        return found;
    }
    void expect_resumed(const std::string& when) {
        const Outcome resumed = lucarne(convert("--resume"));
        ASSERT_EQ(resumed.code, 0) << when << '\n' << resumed.text;
        ASSERT_TRUE(read_bytes(cache_) == reference_) << when;
        ASSERT_TRUE(leftovers().empty()) << when;
        fs::remove(cache_);
    }
    /// Kills a conversion after the chunks are written and before normals are estimated.
    void interrupt() {
        for (uint64_t call = 1; call <= calls_; ++call) {
            ASSERT_EQ(lucarne_with_fault("kill:" + std::to_string(call), convert("")).code, -1);
            const auto left = leftovers();  // empty before the folder is made
            if (!left.empty() && read_bytes(left[0] / "journal").find("chunk") != std::string::npos) return;
        }
        FAIL() << "no chunks were ever finished";
    }

    const io::testing::TemporaryFolder folder_;
    const fs::path scan_ = folder_ / "a.las", cache_ = folder_ / "a.luc";
    uint64_t calls_ = 0, last_write_ = 0;  ///< the last write before the output is synced
    std::string reference_;
};

TEST_F(Conversion, KilledAtAnyCallLeavesNoCacheAndGoesOnToTheSameBytes) {
    for (uint64_t call = 1; call <= calls_; call += 1 + calls_ / 40) {
        const auto killed = lucarne_with_fault("kill:" + std::to_string(call), convert(""));
        ASSERT_EQ(killed.code, -1) << call << killed.text;
        const bool whole =
            !fs::exists(cache_) || read_bytes(cache_) == reference_;  // killed at the last step
        ASSERT_TRUE(whole) << call;
        fs::remove(cache_);
        expect_resumed("killed at call " + std::to_string(call));
    }
}

TEST_F(Conversion, KilledOverAnOldCacheLeavesThatOrTheNewOne) {
    write_bytes(cache_, "old");
    for (uint64_t call = 1; call <= calls_ + 1; call += 1 + calls_ / 10) {
        ASSERT_NE(lucarne_with_fault("kill:" + std::to_string(call), convert("--overwrite")).code, 1) << call;
        const auto bytes = read_bytes(cache_);
        ASSERT_TRUE(bytes == "old" || bytes == reference_) << call;
        write_bytes(cache_, "old");
    }
}

TEST_F(Conversion, GoesOnOverAndOverUntilItIsDone) {
    // Each run is killed a little later and continues from the stages that the previous run finished.
    for (uint64_t call = 1; call < 8; ++call)
        ASSERT_EQ(lucarne_with_fault("kill:" + std::to_string(call), convert("--resume")).code, -1);
    expect_resumed("killed seven times");
}

TEST_F(Conversion, GoesOnToTheSameBytesAfterAPowerCut) {
    for (uint64_t call = 1, seed = 1; call <= calls_; call += 1 + calls_ / 20, ++seed) {
        const auto fault = "power:" + std::to_string(call) + ":" + std::to_string(seed);
        ASSERT_EQ(lucarne_with_fault(fault, convert("")).code, -1);
        const bool whole = !fs::exists(cache_) || read_bytes(cache_) == reference_;
        ASSERT_TRUE(whole) << fault;
        fs::remove(cache_);
        expect_resumed(fault);
    }
}

TEST_F(Conversion, ReportsADiskThatIsFullAtAnyWriteAndLeavesNothing) {
    for (uint64_t call = 1; call < calls_; call += 1 + calls_ / 30) {
        const auto full = lucarne_with_fault("full:" + std::to_string(call), convert(""));
        if (full.code == 0) {  // the failed call was only a hint
            ASSERT_TRUE(read_bytes(cache_) == reference_) << call;
            fs::remove(cache_);
            continue;
        }
        ASSERT_EQ(full.code, 1) << call << full.text;
        EXPECT_NE(full.text.find("No space left on device"), std::string::npos) << full.text;
        ASSERT_FALSE(fs::exists(cache_)) << call;
        ASSERT_TRUE(leftovers().empty()) << call;
    }
}

TEST_F(Conversion, ReportsAnyCallThatFails) {
    for (uint64_t call = 1; call <= calls_; call += 1 + calls_ / 30) {
        const auto outcome = lucarne_with_fault("error:" + std::to_string(call), convert(""));
        // A failed hint is no error. After the output is named, only the folder's sync remains.
        const bool named = fs::exists(cache_);
        ASSERT_EQ(outcome.code, named && outcome.text.find("cannot be synced") == std::string::npos ? 0 : 1)
            << call << outcome.text;
        if (named) {
            ASSERT_TRUE(read_bytes(cache_) == reference_) << call;
            fs::remove(cache_);
        }
        ASSERT_TRUE(leftovers().empty()) << call;
    }
}

TEST_F(Conversion, WithResumeKeepsWhatIsDoneWhenTheDiskIsFull) {
    const auto full = lucarne_with_fault("full:" + std::to_string(last_write_), convert("--resume"));
    ASSERT_EQ(full.code, 1) << full.text;
    ASSERT_EQ(leftovers().size(), 1u);
    const auto resumed = lucarne(convert("--resume"));
    ASSERT_EQ(resumed.code, 0) << resumed.text;
    EXPECT_NE(resumed.text.find("going on after 'normals'"), std::string::npos) << resumed.text;
    EXPECT_TRUE(read_bytes(cache_) == reference_);
}

TEST_F(Conversion, IsNotBlockedByWhatAnotherLeft) {
    interrupt();
    const auto outcome = lucarne(convert(""));
    ASSERT_EQ(outcome.code, 0) << outcome.text;
    EXPECT_NE(outcome.text.find("removed"), std::string::npos) << outcome.text;
    EXPECT_TRUE(read_bytes(cache_) == reference_);
    EXPECT_TRUE(leftovers().empty());
}

TEST_F(Conversion, StartsAgainWhereOptionsOrInputsAreOthers) {
    interrupt();
    const auto other = lucarne("convert --memory 64M --resume " + quoted(scan_) + " -o " + quoted(cache_));
    ASSERT_EQ(other.code, 0) << other.text;
    EXPECT_NE(other.text.find("starting from the beginning"), std::string::npos) << other.text;
    fs::remove(cache_);
    interrupt();
    fs::last_write_time(scan_, fs::last_write_time(scan_) + std::chrono::seconds(1));
    const auto changed = lucarne(convert("--resume"));
    ASSERT_EQ(changed.code, 0) << changed.text;
    EXPECT_NE(changed.text.find("starting from the beginning"), std::string::npos) << changed.text;
    const std::string resumed = read_bytes(
        cache_);  // not equal to the reference, which contains another modification time of the scan
    fs::remove(cache_);
    ASSERT_EQ(lucarne(convert("")).code, 0);
    EXPECT_TRUE(read_bytes(cache_) == resumed);
}

TEST_F(Conversion, ResumedFromDamagedScratchFilesGivesTheSameBytes) {
    for (uint64_t seed = 0; seed < 12; ++seed) {
        interrupt();
        const auto left = leftovers();
        ASSERT_EQ(left.size(), 1u);
        const auto file = left[0] / (seed % 2 ? "journal" : "points");
        std::string bytes = read_bytes(file);
        ASSERT_FALSE(bytes.empty());
        Random random(seed);
        bytes[random.next() % bytes.size()] ^= static_cast<char>(1u << random.next() % 8);
        if (seed % 3 == 0) bytes.resize(random.next() % bytes.size());
        write_bytes(file, bytes);
        expect_resumed(file.string() + ", seed " + std::to_string(seed));
    }
}

TEST_F(Conversion, RefusesASecondOneAtTheSameTime) {
    interrupt();
    const auto held = UpdateFile::open(leftovers()[0] / "journal", "");
    ASSERT_TRUE(held);
    const auto second = lucarne(convert("--resume"));
    EXPECT_EQ(second.code, 1);
    EXPECT_NE(second.text.find("another conversion"), std::string::npos) << second.text;
}

TEST_F(Conversion, ReportsWhatConversionsOfOtherCachesLeft) {
    interrupt();
    const auto other =
        lucarne("convert --normals none " + quoted(scan_) + " -o " + quoted(folder_ / "b.luc"));
    ASSERT_EQ(other.code, 0) << other.text;
    EXPECT_NE(other.text.find("of an interrupted conversion"), std::string::npos) << other.text;
    EXPECT_EQ(leftovers().size(), 1u);
    expect_resumed("after another");
}

}  // namespace
}  // namespace lucarne
