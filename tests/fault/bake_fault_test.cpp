// What engines compute in advance, on disks that fail: pictures are made all the same, a file that was kept
// stays until a new one is whole, and one line tells what is wrong.
#include <sstream>

#include <gmock/gmock.h>
#include <unistd.h>

#include "tests/fault/run_lucarne.h"
#include "tests/io/io_testing.h"

namespace lucarne {
namespace {

namespace fs = std::filesystem;

using io::testing::read_bytes;
using io::testing::write_bytes;
using test::lucarne;
using test::lucarne_with_fault;
using test::Outcome;
using test::quoted;
using ::testing::AllOf;
using ::testing::HasSubstr;
using ::testing::Not;

class BakeFaults : public ::testing::Test {
 protected:
    void SetUp() override {
        ::setenv("MESA_SHADER_CACHE_DISABLE", "true", 1);  // its files would count as calls
        ::setenv("XDG_CACHE_HOME", (folder_ / "no-folder").c_str(), 1);
        write_bytes(folder_ / "no-folder", "a file");
        fs::create_directory(at_);
        make_cache(cache_, "cornell");
    }
    void TearDown() override {
        ::unsetenv("MESA_SHADER_CACHE_DISABLE");
        ::unsetenv("XDG_CACHE_HOME");
    }
    void make_cache(const fs::path& cache, const std::string& scene) const {
        const auto scan = quoted(folder_ / (scene + ".las"));
        ASSERT_EQ(lucarne("generate " + scene + " --points 2k -o " + scan).code, 0);
        ASSERT_EQ(lucarne("convert --normals estimate " + scan + " -o " + quoted(cache)).code, 0);
    }
    /// The arguments of a command whose result depends on `spacing`.
    std::string prepare(int spacing) const {
        return "prepare " + quoted(cache_) + " --engine paths --preset preview --point-spacing " +
               std::to_string(spacing);
    }
    std::string render(int spacing) const {
        return "render" + prepare(spacing).substr(7) + " --size 16x16 --overwrite -o " +
               quoted(folder_ / "a.exr");
    }
    /// Expects that the folder holds the cache, the file if it has a content, and nothing else; and that the
    /// file is whole.
    void expect_kept(const std::vector<std::string>& one_of, const std::string& when) const {
        const bool there = fs::exists(file_);
        const auto files = std::distance(fs::directory_iterator(at_), fs::directory_iterator());
        ASSERT_EQ(files, there ? 2 : 1) << when << ": something is left behind";
        const std::string now = there ? read_bytes(file_) : "";
        ASSERT_TRUE(std::ranges::find(one_of, now) != one_of.end()) << when << ": " << now.size() << " bytes";
    }
    /// Returns the lines that name the file and say more than its name and a time.
    size_t complaints(const std::string& text) const {
        size_t count = 0;
        std::istringstream lines(text);
        for (std::string line; std::getline(lines, line);)
            count += line.find(file_.string() + ": ") != line.npos && !line.ends_with(" s");
        return count;
    }
    /// Sets the old content, and returns that of the file that `arguments` make of it, with the number of
    /// calls.
    std::pair<std::string, size_t> try_out(const std::string& old, const std::string& arguments) {
        restore(old);
        const auto calls = test::traced_calls(folder_ / "calls", arguments);
        EXPECT_GT(test::last_call(calls, "linkat"), 3u);
        return {read_bytes(file_), calls.size()};
    }
    /// Returns the next call to fail: every fourth write, then each of the commit.
    static size_t next(size_t call, size_t calls) { return call + (call + 8 < calls ? 4 : 1); }
    void restore(const std::string& old) const {
        for (const auto& entry : fs::directory_iterator(at_))
            if (entry.path() != cache_) fs::remove(entry.path());
        if (!old.empty()) write_bytes(file_, old);
    }
    std::string made(int spacing) {
        restore("");
        EXPECT_EQ(lucarne(prepare(spacing)).code, 0);
        return read_bytes(file_);
    }

    const io::testing::TemporaryFolder folder_;
    const fs::path at_ = folder_ / "at", cache_ = at_ / "a.luc", file_ = at_ / "a.luc.paths.bake";
};

TEST_F(BakeFaults, AFailedCallIsOneLineAndTheOldFileStays) {
    const std::string other = made(150);
    for (const std::string& old : {std::string(), other}) {
        const auto [whole, calls] = try_out(old, prepare(100));
        for (const char* kind : {"full:", "error:"})
            for (size_t call = 1; call < calls; call = next(call, calls)) {
                const std::string fault = kind + std::to_string(call);
                restore(old);
                const Outcome outcome = lucarne_with_fault(fault, prepare(100));
                ASSERT_TRUE(outcome.code == 0 || outcome.code == 1) << fault << outcome.text;
                // A name that cannot be synced stays.
                expect_kept(outcome.code == 0 ? std::vector{whole} : std::vector{old, whole}, fault);
                EXPECT_EQ(complaints(outcome.text), size_t{outcome.code == 1} + !old.empty())
                    << fault << outcome.text;
            }
    }
}

TEST_F(BakeFaults, KilledOrWithoutPowerTheFileIsTheOldOneOrTheNew) {
    const std::string other = made(150);
    for (const std::string& old : {std::string(), other}) {
        const auto [whole, calls] = try_out(old, prepare(100));
        for (const char* kind : {"kill:", "power:"})
            for (size_t call = 1; call <= calls; call = next(call, calls)) {
                const std::string fault = kind + std::to_string(call);
                restore(old);
                ASSERT_EQ(lucarne_with_fault(fault, prepare(100)).code, -1) << fault;
                const std::string now = fs::exists(file_) ? read_bytes(file_) : "";
                ASSERT_TRUE(now == old || now == whole) << fault << ": " << now.size() << " bytes";
            }
    }
}

TEST_F(BakeFaults, APictureIsMadeAlthoughWhatItTookCannotBeKept) {
    made(150);
    const std::string old = read_bytes(file_);
    for (const char* fault : {"error:1", "error:3:28"}) {
        const Outcome outcome = lucarne_with_fault(fault, render(100));
        EXPECT_EQ(outcome.code, 0) << outcome.text;
        EXPECT_THAT(outcome.text, HasSubstr("it will be computed again"));
        EXPECT_EQ(complaints(outcome.text), 2u) << outcome.text;
        expect_kept({old}, fault);
    }
}

TEST_F(BakeFaults, ADamagedFileIsOneLineAndComputedAgain) {
    const std::string whole = made(100);
    std::vector<std::string> wrong;
    for (size_t i = 0; i < 8; ++i) {
        wrong.push_back(whole.substr(0, whole.size() * i / 8));
        wrong.push_back(whole);
        wrong.back()[whole.size() * i / 8 + 3] ^= 0x10;
    }
    for (const std::string& bytes : wrong) {
        write_bytes(file_, bytes);
        const Outcome outcome = lucarne(prepare(100));
        ASSERT_EQ(outcome.code, 0) << outcome.text;
        EXPECT_EQ(complaints(outcome.text), 1u) << outcome.text;
        EXPECT_THAT(outcome.text, HasSubstr("; it is computed again"));
        expect_kept({whole}, std::to_string(bytes.size()));
    }
}

TEST_F(BakeFaults, TheFileOfAnotherScanIsNotUsed) {
    const std::string whole = made(100);
    make_cache(folder_ / "b.luc", "two-rooms");
    ASSERT_EQ(lucarne("prepare " + quoted(folder_ / "b.luc") + " --engine paths --preset preview").code, 0);
    write_bytes(file_, read_bytes(folder_ / "b.luc.paths.bake"));
    const Outcome outcome = lucarne(prepare(100));
    ASSERT_EQ(outcome.code, 0) << outcome.text;
    EXPECT_EQ(complaints(outcome.text), 1u) << outcome.text;
    EXPECT_THAT(outcome.text, HasSubstr("was computed from another scan, scene or options"));
    expect_kept({whole}, "another scan");
}

/// A folder that this user cannot write to. Root may write everywhere, so the program runs as another user.
class ReadOnlyFolder : public BakeFaults {
 protected:
    void SetUp() override {
        if (test::run(user_ + "test -x " LUCARNE_BINARY).code != 0)
            GTEST_SKIP() << "another user may not run the program here";
        BakeFaults::SetUp();
        fs::permissions(folder_.path(), fs::perms::owner_all | fs::perms::others_exec);
        fs::create_directory(mine_);
        fs::permissions(mine_, fs::perms::all);
    }
    void TearDown() override {
        std::error_code absent;
        fs::permissions(at_, fs::perms::owner_all, absent);
        BakeFaults::TearDown();
    }
    /// Runs the program with the folder locked and this folder for caches.
    Outcome locked(const std::string& arguments, const fs::path& caches) const {
        fs::permissions(at_, fs::perms::owner_read | fs::perms::owner_exec | fs::perms::others_read |
                                 fs::perms::others_exec);
        const Outcome outcome = test::run("XDG_CACHE_HOME=" + quoted(caches) + " HOME=" + quoted(mine_) +
                                          " " + user_ + LUCARNE_BINARY " " + arguments);
        fs::permissions(at_, fs::perms::owner_all);
        return outcome;
    }
    const fs::path mine_ = folder_ / "mine";
    const std::string user_ = ::geteuid() == 0 ? "setpriv --reuid=65534 --regid=65534 --clear-groups " : "";
};

TEST_F(ReadOnlyFolder, TheResultIsKeptInTheUsersFolder) {
    const Outcome first = locked(prepare(100), mine_);
    ASSERT_EQ(first.code, 0) << first.text;
    expect_kept({""}, "nothing beside the cache");
    EXPECT_THAT(first.text, HasSubstr((mine_ / "lucarne").string()));
    const Outcome again = locked(prepare(100), mine_);
    ASSERT_EQ(again.code, 0) << again.text;
    EXPECT_THAT(again.text, Not(HasSubstr("computed again")));
}

TEST_F(ReadOnlyFolder, WhatIsKeptBesideTheCacheIsUsedAndStays) {
    const std::string whole = made(100);
    for (const fs::path& caches : {mine_, folder_ / "no-folder"}) {
        const Outcome used = locked(prepare(100), caches);
        ASSERT_EQ(used.code, 0) << used.text;
        EXPECT_THAT(used.text, AllOf(HasSubstr(file_.string()), Not(HasSubstr("computed again"))));
        expect_kept({whole}, "used");
    }
    const Outcome other = locked(prepare(150), mine_);
    ASSERT_EQ(other.code, 0) << other.text;
    EXPECT_EQ(complaints(other.text), 1u) << other.text;
    expect_kept({whole}, "another was computed");
}

TEST_F(ReadOnlyFolder, WithoutAnyPlacePrepareFails) {
    const Outcome failed = locked(prepare(100), folder_ / "no-folder");
    EXPECT_EQ(failed.code, 1) << failed.text;
    EXPECT_THAT(failed.text, HasSubstr("there is no place to keep what was computed"));
    expect_kept({""}, "nowhere");
}

}  // namespace
}  // namespace lucarne
