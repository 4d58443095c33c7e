// Updates of a cache that are killed, run out of space or lose unsynced data: the cache has the old state or
// the new one, and nothing in between.
#include <algorithm>

#include <gtest/gtest.h>

#include "octree/cache/cache.h"
#include "tests/fault/run_lucarne.h"
#include "tests/octree/test_sources.h"

namespace lucarne {
namespace {

namespace fs = std::filesystem;

using io::testing::read_bytes;
using io::testing::write_bytes;
using test::lucarne;
using test::lucarne_with_fault;
using test::quoted;

struct Update {
    const char* name;
    std::string arguments;
};

class Updates : public testing::Test {
 protected:
    void SetUp() override {
        ASSERT_EQ(lucarne("generate two-rooms --points 30k --seed 1 -o " + quoted(folder_ / "a.las")).code,
                  0);
        ASSERT_EQ(lucarne("generate two-rooms --points 3k --seed 2 -o " + quoted(folder_ / "b.las")).code, 0);
        const auto built =
            lucarne("convert --normals none " + quoted(folder_ / "a.las") + " -o " + quoted(cache_));
        ASSERT_EQ(built.code, 0) << built.text;
        before_ = read_bytes(cache_);
        old_points_ = points();
    }
    std::vector<Update> updates() const {
        return {{"append", "convert --append " + quoted(folder_ / "b.las") + " -o " + quoted(cache_)},
                {"delete", "delete --box=-100,-100,-100,0.7,100,100 " + quoted(cache_)},
                {"compact", "compact " + quoted(cache_)}};
    }
    /// Returns all records in the cache, sorted, or nothing if it is not sound.
    std::vector<std::string> points() const {
        const auto cache = octree::open_cache(cache_);
        EXPECT_TRUE(cache) << cache.error().line();
        if (!cache) return {};
        // The schema may have more attributes now; the first ones are the old ones.
        return test::sorted_records(**cache, 12);
    }
    /// Runs the update on a copy to learn the new state. Returns the number of calls that change files.
    uint64_t try_out(const Update& update) {
        write_bytes(cache_, before_);
        const auto counted = lucarne_with_fault("count:" + (folder_ / "calls").string(), update.arguments);
        EXPECT_EQ(counted.code, 0) << counted.text;
        new_points_ = points();
        EXPECT_NE(new_points_ == old_points_, std::string(update.name) != "compact");
        return std::stoull(read_bytes(folder_ / "calls"));
    }
    void expect_old_or_new(const std::string& when) {
        const auto now = points();
        ASSERT_TRUE(now == old_points_ || now == new_points_) << when << ": " << now.size() << " points";
    }
    /// Expects that the same update can be repeated and leaves a cache that verifies.
    void expect_repairable(const Update& update, const std::string& when) {
        write_bytes(folder_ / "now.luc", read_bytes(cache_));
        const bool old = points() == old_points_;
        if (old) {
            ASSERT_EQ(lucarne(update.arguments).code, 0) << when;
        }
        ASSERT_TRUE(points() == new_points_) << when;
        // After one more update both superblocks are sound again.
        ASSERT_EQ(lucarne("compact " + quoted(cache_)).code, 0) << when;
        const auto verified = lucarne("verify " + quoted(cache_));
        ASSERT_EQ(verified.code, 0) << when << verified.text;
    }

    const test::TempFolder folder_;
    const fs::path cache_ = folder_ / "a.luc";
    std::string before_;
    std::vector<std::string> old_points_, new_points_;
};

TEST_F(Updates, KilledAtAnyCallLeaveTheOldStateOrTheNew) {
    for (const auto& update : updates()) {
        const uint64_t calls = try_out(update);
        for (uint64_t call = 1; call <= calls; call += 1 + calls / 12) {
            const auto when = std::string(update.name) + " killed at call " + std::to_string(call);
            write_bytes(cache_, before_);
            ASSERT_EQ(lucarne_with_fault("kill:" + std::to_string(call), update.arguments).code, -1) << when;
            expect_old_or_new(when);
            expect_repairable(update, when);
        }
    }
}

TEST_F(Updates, WithoutPowerLeaveTheOldStateOrTheNewWhateverWasNotSynced) {
    for (const auto& update : updates()) {
        const uint64_t calls = try_out(update);
        for (uint64_t call = 1, seed = 1; call <= calls;
             call += 1 + (call + 8 < calls ? calls / 8 : 0), ++seed) {
            const auto fault = "power:" + std::to_string(call) + ":" + std::to_string(seed);
            write_bytes(cache_, before_);
            ASSERT_EQ(lucarne_with_fault(fault, update.arguments).code, -1) << fault;
            expect_old_or_new(update.name + (" " + fault));
            expect_repairable(update, update.name + (" " + fault));
        }
    }
}

TEST_F(Updates, ThatFailAtAnyCallSaySoAndLeaveTheOldState) {
    for (const auto& update : updates()) {
        const uint64_t calls = try_out(update);
        for (const char* kind : {"full:", "error:"})
            for (uint64_t call = 1; call <= calls; call += 1 + calls / 8) {
                const auto fault = kind + std::to_string(call);
                write_bytes(cache_, before_);
                const auto outcome = lucarne_with_fault(fault, update.arguments);
                expect_old_or_new(update.name + (" " + fault));
                if (outcome.code == 0) {  // the failed call was only a hint
                    ASSERT_TRUE(points() == new_points_) << update.name << fault;
                    continue;
                }
                ASSERT_EQ(outcome.code, 1) << update.name << fault << outcome.text;
                ASSERT_NE(outcome.text.find("cannot be"), std::string::npos) << outcome.text;
            }
    }
}

TEST_F(Updates, EndWithOneLineAndTheRightCodeWhenTheyAreWrong) {
    struct Case {
        std::string arguments;
        int code;
        const char* says;
    };
    const auto cache = quoted(cache_), scan = quoted(folder_ / "b.las"),
               other = quoted(folder_ / "other.luc");
    std::filesystem::copy_file(folder_ / "b.las", folder_ / "other.luc");
    for (const auto& [arguments, code, says] :
         {Case{"convert --append " + scan + " -o " + quoted(folder_ / "absent.luc"), 3, "No such file"},
          Case{"convert --append " + scan + " -o " + scan, 2, "the name of a scan"},
          Case{"convert --append " + scan + " -o " + other, 3, "is not a Lucarne cache"},
          Case{"convert --append --resume " + scan + " -o " + cache, 2, "--resume"},
          Case{"convert --append --memory 1M " + scan + " -o " + cache, 2, "too little"},
          Case{"delete " + cache, 2, "--box"},
          Case{"delete --scan 7 " + cache, 2, "none of the cache's 1 scans"},
          Case{"delete --scan 0 " + cache, 2, "no points left"},
          Case{"delete --box 1,1,1,0,0,0 " + cache, 2, "lower corner"},
          Case{"delete --box 1,2,3 " + cache, 2, "--box"},
          Case{"compact " + scan, 3, "is not a Lucarne cache"}}) {
        const auto outcome = lucarne(arguments);
        EXPECT_EQ(outcome.code, code) << arguments << '\n' << outcome.text;
        EXPECT_NE(outcome.text.find(says), std::string::npos) << arguments << '\n' << outcome.text;
    }
    EXPECT_EQ(read_bytes(cache_), before_);
}

}  // namespace
}  // namespace lucarne
