// Folders and files with guessable names: only the user's own are opened.
#include "io/files/private_file.h"

#include <array>

#include <gtest/gtest.h>
#include <sys/stat.h>
#include <unistd.h>

#include "tests/io/io_testing.h"

namespace lucarne {
namespace {

namespace fs = std::filesystem;

using io::testing::read_bytes;
using io::testing::TemporaryFolder;
using io::testing::write_bytes;

void expect_opens(const fs::path& file, bool create) {
    const auto fd = open_private_file(file, create);
    ASSERT_TRUE(fd) << fd.error().line();
    ::close(*fd);
}

TEST(PrivateFolder, IsMadeForThisUserAloneWhateverTheMask) {
    const TemporaryFolder folder;
    const mode_t mask = ::umask(0);
    const auto made = make_private_folder(folder / "a");
    ::umask(mask);
    ASSERT_TRUE(made) << made.error().line();
    EXPECT_EQ(fs::status(folder / "a").permissions(), fs::perms::owner_all);
    EXPECT_TRUE(make_private_folder(folder / "a")) << "one's own is taken";
    expect_opens(folder / "a" / "file", true);
    expect_opens(folder / "a" / "file", false);
    EXPECT_FALSE(open_private_file(folder / "a" / "none", false));
}

TEST(PrivateFolder, ThatIsALinkAFileOrOpenToOthersIsRefused) {
    const TemporaryFolder folder;
    fs::create_directory(folder / "mine");
    fs::create_directory_symlink(folder / "mine", folder / "link");
    write_bytes(folder / "file", "");
    fs::create_directory(folder / "open");
    fs::permissions(folder / "open", fs::perms::group_write, fs::perm_options::add);
    for (const char* name : {"link", "file", "open"}) {
        EXPECT_FALSE(make_private_folder(folder / name)) << name;
        EXPECT_FALSE(open_private_file(folder / name / "file", true)) << name;
    }
    EXPECT_TRUE(fs::is_empty(folder / "mine"));
}

TEST(PrivateFile, ThatIsALinkAPipeOrHasASecondNameIsRefused) {
    const TemporaryFolder folder;
    write_bytes(folder / "precious", "mine");
    fs::create_symlink(folder / "precious", folder / "link");
    fs::create_hard_link(folder / "precious", folder / "second");
    ASSERT_EQ(::mkfifo((folder / "pipe").c_str(), 0600), 0);
    for (const char* name : {"link", "second", "pipe", "."})
        EXPECT_FALSE(open_private_file(folder / name, true)) << name;
    EXPECT_EQ(read_bytes(folder / "precious"), "mine");
}

TEST(PrivateFile, OfAnotherUserIsRefused) {
    if (::geteuid() != 0) GTEST_SKIP() << "only root can make a file of another user";
    const TemporaryFolder folder;
    write_bytes(folder / "file", "");
    ASSERT_EQ(::chown((folder / "file").c_str(), 65534, 65534), 0);
    EXPECT_FALSE(open_private_file(folder / "file", true));
    ASSERT_TRUE(make_private_folder(folder / "a"));
    ASSERT_EQ(::chown((folder / "a").c_str(), 65534, 65534), 0);
    EXPECT_FALSE(make_private_folder(folder / "a"));
}

TEST(PrivateFolder, LosesOnlyTheFilesThatAreNamed) {
    const TemporaryFolder folder;
    const auto made = new_private_folder(folder.path());
    ASSERT_TRUE(made);
    for (const char* name : {"a", "b", "other"}) write_bytes(*made / name, name);
    const std::array<std::string, 2> files = {"a", "b"};
    remove_private_folder(*made, files);
    EXPECT_FALSE(fs::exists(*made / "a"));
    EXPECT_TRUE(fs::exists(*made / "other"));
    fs::remove(*made / "other");
    remove_private_folder(*made, files);
    EXPECT_FALSE(fs::exists(*made));
}

}  // namespace
}  // namespace lucarne
