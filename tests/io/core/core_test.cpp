// io/core: files appear whole or not at all, and user input is understood or refused.
#include <array>
#include <atomic>
#include <csignal>
#include <map>

#include <gmock/gmock.h>
#include <sys/mount.h>
#include <sys/resource.h>
#include <sys/stat.h>
#include <sys/wait.h>

#include "io/core/counted.h"
#include "io/core/options.h"
#include "io/core/parallel.h"
#include "io/core/random.h"
#include "io/core/terminal.h"
#include "io/files/file.h"
#include "tests/io/io_testing.h"

namespace lucarne {
namespace {

using io::testing::read_bytes;
using io::testing::TemporaryFolder;
using io::testing::write_bytes;
using ::testing::HasSubstr;

size_t entries(const std::filesystem::path& folder) {
    return static_cast<size_t>(
        std::distance(std::filesystem::directory_iterator(folder), std::filesystem::directory_iterator()));
}

Result<void> write_file(const std::filesystem::path& path, std::string_view text, bool overwrite = false) {
    LUCARNE_ASSIGN(auto file, OutputFile::create(path, overwrite));
    LUCARNE_TRY(file.append(text));
    return file.commit();
}

TEST(Counted, OneIsSingular) {
    EXPECT_EQ(counted(0, "points"), "0 points");
    EXPECT_EQ(counted(1, "points"), "1 point");
    EXPECT_EQ(counted(1, "whole triangles"), "1 whole triangle");
    EXPECT_EQ(counted(1, "extended variable length records that are not there"),
              "1 extended variable length record that is not there");
    EXPECT_EQ(counted(1, "points that are not there: the file ends before them"),
              "1 point that is not there: the file ends before it");
    EXPECT_EQ(counted(1, "images ignored"), "1 image ignored");
    EXPECT_EQ(counted(1, "entries of 'faces', which are not read"), "1 entry of 'faces', which is not read");
    EXPECT_EQ(counted(1, "faces that make no sense"), "1 face that makes no sense");
    EXPECT_EQ(counted(2, "faces that make no sense"), "2 faces that make no sense");
    EXPECT_EQ(counted(1, ""), "1 ");
}

TEST(OutputFile, AppearsOnlyWhenCommitted) {
    const TemporaryFolder folder;
    {
        auto file = OutputFile::create(folder / "a", false);
        ASSERT_TRUE(file);
        ASSERT_TRUE(file->append("half"));
        EXPECT_FALSE(std::filesystem::exists(folder / "a"));
    }
    EXPECT_EQ(entries(folder.path()), 0u);
    ASSERT_TRUE(write_file(folder / "a", "whole"));
    EXPECT_EQ(read_bytes(folder / "a"), "whole");
    EXPECT_EQ(entries(folder.path()), 1u);
}

TEST(OutputFile, KeepsAnExistingFileUntilTheNewOneIsWhole) {
    const TemporaryFolder folder;
    write_bytes(folder / "a", "old");
    const auto refused = OutputFile::create(folder / "a", false);
    ASSERT_FALSE(refused);
    EXPECT_THAT(refused.error().line(), HasSubstr("exists already"));
    {
        auto file = OutputFile::create(folder / "a", true);
        ASSERT_TRUE(file && file->append("half"));
        EXPECT_EQ(read_bytes(folder / "a"), "old");
    }
    EXPECT_EQ(read_bytes(folder / "a"), "old");
    ASSERT_TRUE(write_file(folder / "a", "new", true));
    EXPECT_EQ(read_bytes(folder / "a"), "new");
    EXPECT_EQ(entries(folder.path()), 1u);
}

TEST(OutputFile, ANameTakenMeanwhileIsNotOverwritten) {
    const TemporaryFolder folder;
    auto file = OutputFile::create(folder / "a", false);
    ASSERT_TRUE(file && file->append("late"));
    write_bytes(folder / "a", "early");
    EXPECT_FALSE(file->commit());
    EXPECT_EQ(read_bytes(folder / "a"), "early");
}

TEST(OutputFile, TwoOfOneNameDoNotDisturbEachOther) {
    const TemporaryFolder folder;
    auto one = OutputFile::create(folder / "a", true), two = OutputFile::create(folder / "a", true);
    ASSERT_TRUE(one && two && one->append("one") && two->append("two"));
    ASSERT_TRUE(one->commit() && two->commit());
    EXPECT_EQ(read_bytes(folder / "a"), "two");
    EXPECT_EQ(entries(folder.path()), 1u);
}

TEST(OutputFile, PlacesThatCannotBeWrittenAreRefusedBeforeTheWork) {
    const TemporaryFolder folder;
    write_bytes(folder / "file", "x");
    std::filesystem::create_directory(folder / "sub");
    std::filesystem::create_symlink("nowhere", folder / "link");
    ASSERT_EQ(mkfifo((folder / "pipe").c_str(), 0600), 0);
    const std::map<std::string, std::string> reasons = {{"missing/a", "does not exist"},
                                                        {"file/a", "does not exist"},
                                                        {"sub", "is a folder"},
                                                        {"sub/", "is not a file name"},
                                                        {"link", "exists already"},
                                                        {"pipe", "is a device"},
                                                        {std::string(300, 'n'), "cannot be created"}};
    for (const auto& [name, reason] : reasons) {
        const auto checked = check_output(folder / name, name == "pipe");
        ASSERT_FALSE(checked) << name;
        EXPECT_THAT(checked.error().line(), HasSubstr(reason));
        EXPECT_FALSE(OutputFile::create(folder / name, name == "pipe")) << name;
    }
    if (geteuid() != 0) {  // root can write everywhere
        std::filesystem::permissions(folder / "sub",
                                     std::filesystem::perms::owner_read | std::filesystem::perms::owner_exec);
        EXPECT_FALSE(check_output(folder / "sub/a", false));
    }
}

TEST(OutputFile, AKilledProcessLeavesNothing) {
    const TemporaryFolder folder;
    const pid_t child = fork();
    if (child == 0) {
        auto file = OutputFile::create(folder / "a", false);
        if (file) (void)file->append("half");
        ::kill(getpid(), SIGKILL);
    }
    int status = 0;
    ASSERT_EQ(waitpid(child, &status, 0), child);
    ASSERT_TRUE(WIFSIGNALED(status));
    EXPECT_EQ(entries(folder.path()), 0u);
}

/// Limits the size of files while it lives: a write beyond it fails as on a full disk.
class FileSizeLimit {
 public:
    explicit FileSizeLimit(rlim_t bytes) {
        handler_ = std::signal(SIGXFSZ, SIG_IGN);
        getrlimit(RLIMIT_FSIZE, &old_);
        const rlimit limit{bytes, old_.rlim_max};
        setrlimit(RLIMIT_FSIZE, &limit);
    }
    ~FileSizeLimit() {
        setrlimit(RLIMIT_FSIZE, &old_);
        std::signal(SIGXFSZ, handler_);
    }
    FileSizeLimit(const FileSizeLimit&) = delete;

 private:
    rlimit old_{};
    void (*handler_)(int) = SIG_DFL;
};

TEST(OutputFile, AWriteThatFailsIsAnErrorAndLeavesNothing) {
    const TemporaryFolder folder;
    const std::string large(100'000, 'x');
    Result<void> written;
    {
        const FileSizeLimit limit(65536);
        written = write_file(folder / "a", large);
    }
    ASSERT_FALSE(written);
    EXPECT_EQ(written.error().kind, ErrorKind::failed);
    EXPECT_THAT(written.error().line(), HasSubstr("cannot be written"));
    EXPECT_EQ(entries(folder.path()), 0u);
}

TEST(OutputFile, AFullDiskIsAnErrorThatSaysWhatToDo) {
    const TemporaryFolder folder;
    if (mount("tmpfs", folder.path().c_str(), "tmpfs", 0, "size=64k") != 0)
        GTEST_SKIP() << "no file system can be mounted here";
    const auto written = write_file(folder / "a", std::string(1 << 20, 'x'));
    const size_t left = entries(folder.path());
    umount(folder.path().c_str());
    ASSERT_FALSE(written);
    EXPECT_THAT(written.error().line(), HasSubstr("free some space"));
    EXPECT_EQ(left, 0u);
}

TEST(OutputFile, CanBeReadAndChangedBeforeItIsCommitted) {
    const TemporaryFolder folder;
    auto file = OutputFile::create(folder / "a", false);
    ASSERT_TRUE(file && file->append("headerbody"));
    EXPECT_EQ(file->position(), 10u);
    const std::string_view late = "HEADER";
    ASSERT_TRUE(file->write_at(0, std::as_bytes(std::span(late))));
    std::array<std::byte, 4> body{};
    ASSERT_TRUE(file->read_at(6, body));
    EXPECT_EQ(std::memcmp(body.data(), "body", 4), 0);
    EXPECT_FALSE(file->read_at(8, body));
    ASSERT_TRUE(file->commit());
    EXPECT_EQ(read_bytes(folder / "a"), "HEADERbody");
}

TEST(InputFile, OnlyRegularFilesThatExistAreOpened) {
    const TemporaryFolder folder;
    ASSERT_EQ(mkfifo((folder / "pipe").c_str(), 0600), 0);  // would block a plain open
    for (const auto& path :
         {folder / "missing", folder / "pipe", folder.path(), std::filesystem::path("/dev/null")}) {
        const auto file = InputFile::open(path);
        ASSERT_FALSE(file) << path;
        EXPECT_EQ(file.error().kind, ErrorKind::input_rejected);
    }
}

TEST(InputFile, AReadPastTheEndSaysHowMuchWasThere) {
    const TemporaryFolder folder;
    write_bytes(folder / "a", "0123456789");
    const auto file = InputFile::open(folder / "a");
    ASSERT_TRUE(file);
    EXPECT_EQ(file->size(), 10u);
    std::array<std::byte, 8> bytes{};
    ASSERT_TRUE(file->read_at(2, bytes));
    const auto read = file->read_at(5, bytes);
    ASSERT_FALSE(read);
    EXPECT_THAT(read.error().line(), HasSubstr("8 bytes wanted at 5, 5 there"));
    EXPECT_EQ(file->read_some(5, bytes).value_or(99), 5u);
    EXPECT_EQ(file->read_some(50, bytes).value_or(99), 0u);
    EXPECT_FALSE(file->read_at(~uint64_t{0}, bytes));  // beyond the largest offset
}

TEST(ScratchFile, HoldsWhatWasWrittenAndHasNoName) {
    const TemporaryFolder folder;
    auto file = ScratchFile::create(folder.path());
    ASSERT_TRUE(file);
    const std::string_view text = "scratch";
    ASSERT_TRUE(file->write_at(1'000'000, std::as_bytes(std::span(text))));
    std::array<std::byte, 7> back{};
    ASSERT_TRUE(file->read_at(1'000'000, back));
    EXPECT_EQ(std::memcmp(back.data(), "scratch", 7), 0);
    file->discard(0, 500'000);
    EXPECT_EQ(entries(folder.path()), 0u);
    EXPECT_FALSE(ScratchFile::create(folder / "missing"));
}

TEST(Options, AmountsOfMemoryAreUnderstoodOrRefused) {
    const std::map<std::string, uint64_t> good = {{"0", 0},
                                                  {"4096", 4096},
                                                  {"4096B", 4096},
                                                  {"1k", 1024},
                                                  {"512M", 512u << 20},
                                                  {"2G", uint64_t{2} << 30},
                                                  {"1.5GiB", uint64_t{3} << 29},
                                                  {"0.5TB", uint64_t{1} << 39}};
    for (const auto& [text, bytes] : good)
        EXPECT_EQ(parse_bytes("--memory", text).value_or(1), bytes) << text;
    for (const char* text :
         {"", "G", "-1G", "1X", "1GG", "1 G", "nan", "inf", "1e30", "0x10", "1Gi", "99999999T", "1GiBs"}) {
        const auto parsed = parse_bytes("--memory", text);
        ASSERT_FALSE(parsed) << text;
        EXPECT_EQ(parsed.error().kind, ErrorKind::arguments);
        EXPECT_THAT(parsed.error().line(), HasSubstr("--memory"));
    }
}

TEST(Options, PictureSizesAreUnderstoodOrRefused) {
    const auto size = parse_size("--size", "1280x720");
    ASSERT_TRUE(size);
    EXPECT_EQ(size->width, 1280u);
    EXPECT_EQ(size->height, 720u);
    for (const char* text : {"", "x", "12", "12x", "x12", "0x5", "5x0", "-1x5", "16385x1", "1x99999999999",
                             "1x2x3", "1X2", " 1x2"})
        EXPECT_FALSE(parse_size("--size", text)) << text;
}

TEST(Options, BytesAreWrittenAsPeopleReadThem) {
    EXPECT_EQ(bytes_text(0), "0 B");
    EXPECT_EQ(bytes_text(1023), "1023 B");
    EXPECT_EQ(bytes_text(1536), "1.5 KiB");
    EXPECT_EQ(bytes_text(uint64_t{3} << 40), "3.0 TiB");
}

TEST(Shown, HasNoControlCharactersAndIsValidUtf8) {
    EXPECT_EQ(shown("Straße 日本 🙂"), "Straße 日本 🙂");
    EXPECT_EQ(shown("\x1b[2J\r\n\t\x7f"), "?[2J????");
    EXPECT_EQ(shown("a\xc2\x9b"
                    "2Jb"),
              "a??2Jb")
        << "the control characters of 8 bits";
    EXPECT_EQ(shown("a\xffz\xc3"), "a?z?") << "bytes that are no UTF-8";
    EXPECT_EQ(shown("\xe2\x80\xae"
                    "fdp.exe"),
              "???fdp.exe")
        << "the mark that turns the direction";
    EXPECT_EQ(shown(""), "");
}

TEST(Shown, OfLongTextsTheMiddleIsLeftOutBetweenCharacters) {
    EXPECT_EQ(shown("0123456789", 10), "0123456789");
    EXPECT_EQ(shown("0123456789abcdef", 11), "012 ... def");
    std::string text;
    for (int i = 0; i < 1000; ++i) text += "日";
    for (size_t most = 20; most < 40; ++most) {
        const std::string part = shown(text, most);
        EXPECT_LE(part.size(), most);
        EXPECT_EQ(part, shown(part)) << most;
    }
}

TEST(Errors, AreShortWhateverTheyQuote) {
    const std::string noise(100'000, 'x');
    EXPECT_LT((Error{ErrorKind::failed, noise, noise, noise}).line().size(), 4000u);
}

TEST(Errors, AreOneLineWhateverAFileIsCalled) {
    const auto error = rejected("evil\n\x1b[2Jname", "is bad", "do this").value();
    EXPECT_EQ(error.line(), "evil??[2Jname: is bad; do this");
    EXPECT_EQ((Error{ErrorKind::failed, "", "why", ""}).line(), "why");
}

TEST(Parallel, PiecesCoverTheRangeOnceWhateverTheThreads) {
    for (const unsigned threads : {1u, 2u, 5u}) {
        const ThreadLimit limit(threads);
        std::vector<std::atomic<int>> seen(1003);
        parallel_ranges(seen.size(), 10, [&](size_t first, size_t last) {
            EXPECT_EQ(first % 10, 0u);
            for (size_t i = first; i < last; ++i) ++seen[i];
        });
        for (const auto& count : seen) EXPECT_EQ(count.load(), 1);
    }
    parallel_ranges(0, 10, [](size_t, size_t) { FAIL(); });
}

TEST(Parallel, TheFirstErrorIsTheOneOfTheLowestOrder) {
    FirstError errors;
    EXPECT_FALSE(errors.any());
    EXPECT_TRUE(errors.result());
    for (const size_t order : {5, 2, 7})
        errors.report(order, Error{ErrorKind::failed, std::to_string(order), "", ""});
    EXPECT_TRUE(errors.any());
    EXPECT_EQ(errors.result().error().what, "2");
}

TEST(Random, IsUniformAndFollowsFromSeedAndStream) {
    Random a(1, 2), same(1, 2), other(1, 3);
    double sum = 0;
    for (int i = 0; i < 10000; ++i) {
        const double u = a.uniform();
        ASSERT_GE(u, 0.0);
        ASSERT_LT(u, 1.0);
        ASSERT_EQ(u, same.uniform());
        ASSERT_NE(u, other.uniform());
        sum += u;
    }
    EXPECT_NEAR(sum / 10000, 0.5, 5 * 0.2887 / 100);  // five standard errors
}

TEST(Advice, NamesTheNearestOnlyIfItIsNear) {
    constexpr std::array<std::string_view, 4> kNames = {"vpl", "direct", "reference", "unlit"};
    const std::string all = "vpl, direct, reference, unlit";
    EXPECT_EQ(advice("vlp", kNames), "did you mean vpl? (all: " + all + ")");
    EXPECT_EQ(advice("refrence", kNames), "did you mean reference? (all: " + all + ")");
    EXPECT_EQ(advice("drect ", kNames), "did you mean direct? (all: " + all + ")");
    for (const std::string_view far : {"", "v", "xyz", "directional-and-much-more", "magic"})
        EXPECT_EQ(advice(far, kNames), "choose one of: " + all) << far;
    EXPECT_EQ(advice(std::string(100'000, 'v'), kNames), "choose one of: " + all);
    EXPECT_EQ(advice("a", {}), "choose one of: ");
}

}  // namespace
}  // namespace lucarne
