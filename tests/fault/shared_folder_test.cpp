// Conversions in a folder that others can write to. The program never writes to files that others put there
// under guessable names.
#include <array>

#include <gmock/gmock.h>
#include <sys/stat.h>
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
using ::testing::HasSubstr;

constexpr uid_t kOtherUser = 65534;

class SharedFolder : public ::testing::Test {
 protected:
    void SetUp() override {
        ASSERT_EQ(lucarne("generate two-rooms --points 3k -o " + quoted(folder_ / "a.las")).code, 0);
        ASSERT_EQ(convert("").code, 0);
        reference_ = read_bytes(cache_);
        fs::remove(cache_);
        // A conversion that is killed before it changes a file in its folder leaves the folder.
        for (int call = 1; work_.empty(); ++call) {
            ASSERT_EQ(lucarne_with_fault("kill:" + std::to_string(call), arguments("")).code, -1);
            for (const auto& entry : fs::directory_iterator(folder_.path()))
                if (entry.path().string().ends_with(".lucarne-work")) work_ = entry.path();
        }
        fs::remove_all(work_);
        fs::create_directory(folder_ / "mine");
        for (const char* file : kFiles) write_bytes(folder_ / "mine" / file, kPrecious);
    }
    std::string arguments(const std::string& options) const {
        return "convert --normals estimate " + options + " " + quoted(folder_ / "a.las") + " -o " +
               quoted(cache_);
    }
    Outcome convert(const std::string& options) const { return lucarne(arguments(options)); }
    /// Makes the folder as an attacker would.
    void make_trap() const {
        fs::create_directory(work_);
        for (const char* file : kFiles) fs::create_symlink(folder_ / "mine" / file, work_ / file);
    }
    void expect_untouched() const {
        for (const char* file : kFiles) EXPECT_EQ(read_bytes(folder_ / "mine" / file), kPrecious) << file;
    }
    /// Expects that the conversion succeeds without the folder and reports that in one line.
    void expect_done_without_it(const std::string& why) const {
        for (const std::string options : {"", "--resume"}) {
            const auto done = convert(options);
            EXPECT_EQ(done.code, 0) << done.text;
            EXPECT_THAT(done.text, HasSubstr(work_.string() + ": " + why));
            EXPECT_THAT(done.text, HasSubstr("this conversion cannot be resumed"));
            EXPECT_TRUE(read_bytes(cache_) == reference_);
            fs::remove(cache_);
            expect_untouched();
        }
    }

    static constexpr std::array kFiles = {"journal", "points", "normals"};
    static constexpr const char* kPrecious = "mine";
    const io::testing::TemporaryFolder folder_;
    const fs::path cache_ = folder_ / "a.luc";
    fs::path work_;
    std::string reference_;
};

TEST_F(SharedFolder, WorkFoldersAreTheUsersAlone) {
    for (int call = 1; !fs::exists(work_ / "journal"); ++call) {
        ASSERT_EQ(lucarne_with_fault("kill:" + std::to_string(call), arguments("")).code, -1);
    }
    struct stat status {};
    ASSERT_EQ(::stat(work_.c_str(), &status), 0);
    EXPECT_EQ(status.st_mode & 07777, 0700u);
}

TEST_F(SharedFolder, AWorkFolderOfAnotherUserIsNotUsed) {
    if (::geteuid() != 0) GTEST_SKIP() << "only root can make a folder of another user";
    make_trap();
    ASSERT_EQ(::chown(work_.c_str(), kOtherUser, kOtherUser), 0);
    expect_done_without_it("belongs to another user");
    EXPECT_TRUE(fs::exists(work_)) << "is not ours to remove";
}

TEST_F(SharedFolder, AWorkFolderThatOthersMayWriteToIsNotUsed) {
    make_trap();
    fs::permissions(work_, fs::perms::all);
    expect_done_without_it("can be written by other users");
}

TEST_F(SharedFolder, ALinkIsNoWorkFolder) {
    fs::create_directory_symlink(folder_ / "mine", work_);
    expect_done_without_it("is a link or not a folder");
    EXPECT_TRUE(fs::is_symlink(work_));
}

TEST_F(SharedFolder, LinksInsideAreNotFollowed) {
    make_trap();
    const auto refused = convert("");
    EXPECT_EQ(refused.code, 1);
    EXPECT_THAT(refused.text, HasSubstr((work_ / "journal").string() + ": is a link"));
    expect_untouched();
    fs::remove(work_ / "journal");
    EXPECT_EQ(convert("").code, 0) << "links to scratch files are removed";
    expect_untouched();
    EXPECT_FALSE(fs::exists(work_));
}

TEST_F(SharedFolder, OtherNamesOfAFileAreNotWrittenTo) {
    fs::create_directory(work_);
    fs::create_hard_link(folder_ / "mine" / "journal", work_ / "journal");
    const auto refused = convert("");
    EXPECT_EQ(refused.code, 1);
    EXPECT_THAT(refused.text, HasSubstr("journal: is not a file of this user alone"));
    expect_untouched();
}

TEST_F(SharedFolder, WhatElseStandsInAWorkFolderIsNotRemoved) {
    fs::create_directory(work_);
    write_bytes(work_ / "other", kPrecious);
    EXPECT_EQ(convert("").code, 0);
    EXPECT_EQ(read_bytes(work_ / "other"), kPrecious);
}

}  // namespace
}  // namespace lucarne
