// Kills the program or cuts its power between any two calls of a commit, from the last write before the first
// sync to the end of the program. The cache must be in the old or the new state, and sound.
#include <functional>

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

struct Operation {
    std::string name, arguments;
    std::function<void()> prepare;
};

class Commit : public ::testing::Test {
 protected:
    void SetUp() override {
        ASSERT_EQ(lucarne("generate two-rooms --points 4k --seed 1 -o " + quoted(folder_ / "a.las")).code, 0);
        ASSERT_EQ(lucarne("generate two-rooms --points 2k --seed 2 -o " + quoted(folder_ / "b.las")).code, 0);
        for (const char* name : {"a", "b"})
            ASSERT_EQ(
                lucarne("convert --normals none " + quoted(scan(name)) + " -o " + quoted(built(name))).code,
                0);
        // A cache with unused space, for compacting.
        fs::copy_file(built("a"), folder_ / "appended.luc");
        ASSERT_EQ(
            lucarne("convert --append " + quoted(scan("b")) + " -o " + quoted(folder_ / "appended.luc")).code,
            0);
        fs::create_directory(at_);
    }
    fs::path scan(const std::string& name) const { return folder_ / (name + ".las"); }
    fs::path built(const std::string& name) const { return folder_ / (name + "-built.luc"); }

    std::vector<Operation> operations() {
        const std::string cache = quoted(cache_),
                          fresh = "convert --normals none " + quoted(scan("a")) + " -o " + cache;
        const auto start_with = [this](const fs::path& file) {
            return [this, file] { fs::copy_file(file, cache_); };
        };
        return {{"build", fresh, [] {}},
                {"build over another", fresh + " --overwrite", start_with(built("b"))},
                {"resume", fresh + " --resume", [this, fresh] { interrupt(fresh); }},
                {"append", "convert --append " + quoted(scan("b")) + " -o " + cache, start_with(built("a"))},
                {"delete", "delete --box=-100,-100,-100,0.7,100,100 " + cache, start_with(built("a"))},
                {"delete most", "delete --box=-100,-100,-100,1.9,100,100 " + cache, start_with(built("a"))},
                {"compact", "compact " + cache, start_with(folder_ / "appended.luc")}};
    }
    /// Leaves the stages from which a resumed conversion continues.
    void interrupt(const std::string& convert) {
        const auto calls = trace(convert);
        const auto sync = std::find(calls.begin(), calls.end(), "fsync") - calls.begin();
        clear();
        ASSERT_EQ(lucarne_with_fault("kill:" + std::to_string(sync), convert).code, -1);
        ASSERT_FALSE(fs::is_empty(at_));
    }
    void clear() const {
        for (const auto& entry : fs::directory_iterator(at_)) fs::remove_all(entry.path());
    }
    std::vector<std::string> trace(const std::string& arguments) const {
        return test::traced_calls(folder_ / "calls", arguments);
    }
    /// Returns all positions in the cache, sorted, or none if there is no cache. Expects that the cache
    /// verifies.
    std::vector<std::string> state(const std::string& when) const {
        if (!fs::exists(cache_)) return {};
        const auto verified = octree::verify_cache(cache_, [](uint64_t) {});
        EXPECT_TRUE(verified) << when << ": " << verified.error().line();
        const auto cache = octree::open_cache(cache_);
        return cache ? test::sorted_records(**cache, 12) : std::vector<std::string>{"damaged"};
    }
    /// Runs the operation with this fault before each call of its commit. `again`: runs it afterwards without
    /// a fault.
    void expect_old_or_new(const Operation& operation, const std::string& fault, const std::string& more,
                           bool again) {
        clear();
        operation.prepare();
        const auto before = state("before");
        const auto calls = trace(operation.arguments);
        const auto after = state("after");
        const auto sync = std::find(calls.begin(), calls.end(), "fsync");
        ASSERT_NE(sync, calls.end()) << operation.name;
        ASSERT_EQ(calls.back(), "exit");
        size_t old_states = 0, new_states = 0;
        for (auto call = static_cast<size_t>(sync - calls.begin()); call <= calls.size(); ++call) {
            const std::string when = operation.name + ", " + fault + " before " + calls[call - 1] +
                                     ", call " + std::to_string(call);
            clear();
            operation.prepare();
            ASSERT_EQ(lucarne_with_fault(fault + ":" + std::to_string(call) + more, operation.arguments).code,
                      -1)
                << when;
            const auto now = state(when);
            ASSERT_TRUE(now == before || now == after) << when << ": " << now.size() << " points";
            ++(now == after ? new_states : old_states);
            if (!again || (now == after && before != after)) continue;
            const auto repeated = lucarne(operation.arguments);
            ASSERT_EQ(repeated.code, 0) << when << '\n' << repeated.text;
            ASSERT_TRUE(state(when) == after) << when;
        }
        EXPECT_GT(new_states, 0u) << operation.name << ": the last calls come after the commit";
        if (before != after) {
            EXPECT_GT(old_states, 0u) << operation.name << ": the first calls come before the commit";
        }
    }

    const test::TempFolder folder_;
    const fs::path at_ = folder_ / "at", cache_ = at_ / "c.luc";
};

TEST_F(Commit, KilledBeforeAnyCallLeavesTheOldStateOrTheNewAndBothVerify) {
    for (const auto& operation : operations()) expect_old_or_new(operation, "kill", "", true);
}

TEST_F(Commit, WithoutPowerBeforeAnyCallLeavesTheOldStateOrTheNewAndBothVerify) {
    for (const auto& operation : operations())
        for (const char* seed : {":1", ":2", ":3"}) expect_old_or_new(operation, "power", seed, false);
}

TEST_F(Commit, WithoutNamelessFilesIsAsSafe) {
    // If a file system cannot make nameless files, an output has a temporary name beside its own until it is
    // complete.
    ::setenv("LUCARNE_NO_TMPFILE", "1", 1);
    for (const auto& operation : operations())
        if (operation.name != "append" && operation.name != "delete")
            expect_old_or_new(operation, "kill", "", false);
    ::unsetenv("LUCARNE_NO_TMPFILE");
}

TEST_F(Commit, WhatAnInterruptedUpdateLeftBehindTheEndIsReportedAndRemoved) {
    const auto append = "convert --append " + quoted(scan("b")) + " -o " + quoted(cache_);
    fs::copy_file(built("a"), cache_);
    const auto calls = trace(append);
    const auto sync = std::find(calls.begin(), calls.end(), "fsync") - calls.begin();
    clear();
    fs::copy_file(built("a"), cache_);
    ASSERT_EQ(lucarne_with_fault("kill:" + std::to_string(sync + 1), append).code, -1);
    const auto verified = lucarne("verify " + quoted(cache_));
    EXPECT_EQ(verified.code, 0) << verified.text;
    EXPECT_NE(verified.text.find(
                  "of an interrupted update behind its end, which do no harm; lucarne compact removes them"),
              std::string::npos)
        << verified.text;
    ASSERT_EQ(lucarne("compact " + quoted(cache_)).code, 0);
    EXPECT_EQ(lucarne("verify " + quoted(cache_)).text.find("interrupted"), std::string::npos);
}

}  // namespace
}  // namespace lucarne
