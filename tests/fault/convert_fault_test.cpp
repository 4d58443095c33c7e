// Conversion with a full disk or wrong arguments: one clear line, the right exit code, no files left behind.
#include <csignal>
#include <string>

#include <gtest/gtest.h>
#include <sys/mount.h>
#include <sys/resource.h>
#include <sys/wait.h>

#include "io/formats/scan.h"
#include "io/synthetic/synthetic.h"
#include "octree/convert/build.h"
#include "tests/fault/run_lucarne.h"
#include "tests/octree/test_sources.h"

namespace lucarne {
namespace {

using test::lucarne;
using test::Outcome;
using test::quoted;
using test::TempFolder;

size_t lines(const std::string& text) {
    return static_cast<size_t>(std::count(text.begin(), text.end(), '\n'));
}

std::unique_ptr<io::PointSource> scan_of(uint64_t points) {
    io::SyntheticOptions options;
    options.points = points;
    options.even = true;
    auto source = io::synthetic_source(options);
    return source ? std::move(*source) : nullptr;
}

/// Limits the size of this process's files to `bytes`, which looks like a full disk.
class FileSizeLimit {
 public:
    explicit FileSizeLimit(rlim_t bytes) {
        handler_ = std::signal(SIGXFSZ, SIG_IGN);
        ::getrlimit(RLIMIT_FSIZE, &before_);
        rlimit limit = before_;
        limit.rlim_cur = bytes;
        ::setrlimit(RLIMIT_FSIZE, &limit);
    }
    ~FileSizeLimit() {
        ::setrlimit(RLIMIT_FSIZE, &before_);
        std::signal(SIGXFSZ, handler_);
    }
    FileSizeLimit(const FileSizeLimit&) = delete;

 private:
    rlimit before_{};
    void (*handler_)(int) = nullptr;
};

TEST(ConvertFaults, LeaveNothingBehindWhereverWritingFails) {
    const auto source = scan_of(100'000);
    ASSERT_TRUE(source);
    const uint64_t whole = 100'000 * source->schema().stride;
    // The limit strikes in the scratch file, since the cache is smaller. resume_test.cpp tests all other
    // places.
    for (const uint64_t limit : {uint64_t{0}, whole / 3, whole - 1}) {
        const TempFolder folder;
        octree::BuildOptions options{
            .inputs = {source.get()}, .output = folder / "a.luc", .normals = octree::NormalsMode::none};
        const auto report = [&] {
            const FileSizeLimit full(limit);
            return octree::build_cache(options);
        }();
        ASSERT_FALSE(report) << limit;
        EXPECT_EQ(report.error().kind, ErrorKind::failed);
        EXPECT_NE(report.error().line().find("cannot be written"), std::string::npos)
            << report.error().line();
        EXPECT_TRUE(std::filesystem::is_empty(folder.path())) << limit;
    }
}

TEST(ConvertFaults, SayThatTheDiskIsFull) {
    const TempFolder folder;
    const auto disk = folder / "disk";
    std::filesystem::create_directory(disk);
    if (::mount("lucarne-test", disk.c_str(), "tmpfs", 0, "size=512k") != 0)
        GTEST_SKIP() << "may not mount a small disk here";
    ASSERT_EQ(lucarne("generate cornell --even --points 200k -o " + quoted(folder / "a.las")).code, 0);
    const auto output_full = lucarne("convert --normals none --temp " + quoted(folder.path()) + " " +
                                     quoted(folder / "a.las") + " -o " + quoted(disk / "a.luc"));
    const auto scratch_full = lucarne("convert --normals none --temp " + quoted(disk) + " " +
                                      quoted(folder / "a.las") + " -o " + quoted(folder / "a.luc"));
    const bool left = !std::filesystem::is_empty(disk) || std::filesystem::exists(folder / "a.luc");
    ::umount(disk.c_str());
    EXPECT_EQ(output_full.code, 1);
    EXPECT_NE(output_full.text.find("No space left on device"), std::string::npos) << output_full.text;
    EXPECT_EQ(scratch_full.code, 1);
    EXPECT_NE(scratch_full.text.find("No space left on device"), std::string::npos) << scratch_full.text;
    EXPECT_FALSE(left);
}

TEST(ConvertFaults, SayThatAFileMayNotGrowFurther) {
    const TempFolder folder;
    const auto scan = quoted(folder / "a.las"), cache = quoted(folder / "a.luc");
    const auto convert = "convert --normals none " + scan + " -o ";
    ASSERT_EQ(lucarne("generate cornell --even --points 50k -o " + scan).code, 0);
    ASSERT_EQ(lucarne(convert + cache).code, 0);
    const auto left_before = std::distance(std::filesystem::directory_iterator(folder.path()), {});
    for (const std::string& arguments :
         {convert + quoted(folder / "b.luc"), "export " + cache + " -o " + quoted(folder / "b.las"),
          "export " + cache + " -o " + quoted(folder / "b.copc.laz")}) {
        const auto outcome = lucarne(arguments, "ulimit -f 64; ");  // blocks of 512 bytes, or of 1024
        EXPECT_EQ(outcome.code, 1) << arguments;
        EXPECT_NE(outcome.text.find("File too large"), std::string::npos) << outcome.text;
    }
    EXPECT_EQ(std::distance(std::filesystem::directory_iterator(folder.path()), {}), left_before);
}

TEST(ConvertFaults, EndWithOneLineAndTheRightCode) {
    const TempFolder folder;
    io::testing::write_bytes(folder / "empty.las", "");
    io::testing::write_bytes(folder / "text.las", "this is no scan at all, whatever it is called");
    io::testing::write_bytes(folder / "taken.luc", "mine");
    std::filesystem::create_directory(folder / "none");
    ASSERT_EQ(lucarne("generate cornell --even --points 1000 -o " + quoted(folder / "ok.las")).code, 0);
    const auto ok = quoted(folder / "ok.las"), output = quoted(folder / "out.luc");
    struct Case {
        std::string arguments;
        int code;
        std::string says;
    };
    const Case cases[] = {
        {"convert " + quoted(folder / "absent.las") + " -o " + output, 3, "No such file"},
        {"convert " + quoted(folder / "none") + " -o " + output, 3, "a folder without scans"},
        {"convert " + quoted(folder / "empty.las") + " -o " + output, 3, "is empty"},
        {"convert " + quoted(folder / "text.las") + " -o " + output, 3,
         "is named .las and has no such header"},
        {"convert " + ok + " -o " + quoted(folder / "taken.luc"), 1, "exists already"},
        {"convert " + ok + " -o " + quoted(folder / "no" / "where.luc"), 1, "does not exist"},
        {"convert " + ok + " -o " + output + " --memory lots", 2, "not an amount of memory"},
        {"convert " + ok + " -o " + output + " --memory 1M", 2, "too little"},
        {"convert " + ok + " -o " + output + " --normals keep", 2, "no normals to keep"},
        {"convert " + ok + " -o " + output + " --normals none --temp " + quoted(folder / "absent"), 1,
         "temporary file"},
        {"convert " + ok, 2, "output"},
        {"verify " + ok, 3, "is not a Lucarne cache"},
        {"verify " + quoted(folder / "absent.luc"), 3, "No such file"},
        {"info " + quoted(folder / "absent.luc"), 3, "No such file"},
        {"export " + ok + " -o " + quoted(folder / "b.las"), 3, "is not a Lucarne cache"},
    };
    for (const auto& tested : cases) {
        const auto outcome = lucarne(tested.arguments);
        EXPECT_EQ(outcome.code, tested.code) << tested.arguments << "\n" << outcome.text;
        EXPECT_NE(outcome.text.find(tested.says), std::string::npos) << tested.arguments << "\n"
                                                                     << outcome.text;
        EXPECT_EQ(lines(outcome.text), 1u) << outcome.text;
    }
    EXPECT_FALSE(std::filesystem::exists(folder / "out.luc"));
    EXPECT_EQ(io::testing::read_bytes(folder / "taken.luc"), "mine");
}

TEST(ConvertFaults, NameAnInputWithoutPointsAmongOthersAndTakeTheOthers) {
    const TempFolder folder;
    ASSERT_EQ(lucarne("generate cornell --even --points 1000 -o " + quoted(folder / "a.las")).code, 0);
    const std::string head = "ply\nformat ascii 1.0\nelement vertex 0\nproperty float x\nproperty float y\n";
    io::testing::write_bytes(folder / "empty.ply", head + "property float z\nend_header\n");
    const std::string empty = quoted(folder / "empty.ply"), to = " --normals none -o ";
    const auto among =
        lucarne("convert " + empty + " " + quoted(folder / "a.las") + to + quoted(folder / "a.luc"));
    EXPECT_EQ(among.code, 0) << "nothing is lost";
    EXPECT_NE(among.text.find("/empty.ply: has no points\n"), std::string::npos) << among.text;
    EXPECT_NE(among.text.find("; without points: " + (folder / "empty.ply").string() + "\n"),
              std::string::npos)
        << among.text;
    const auto alone = lucarne("convert " + empty + to + quoted(folder / "b.luc"));
    EXPECT_EQ(alone.code, 3);
    EXPECT_NE(alone.text.find("/empty.ply: has no points\n"), std::string::npos) << alone.text;
}

TEST(ConvertFaults, NeedNoHandleForEveryInput) {
    const TempFolder folder;
    ASSERT_EQ(lucarne("generate cornell --even --points 1000 -o " + quoted(folder / "a.las")).code, 0);
    std::string inputs;
    for (int i = 0; i < 60; ++i) {  // distinct files, because a file that is given twice is read once
        const auto copy = folder / (std::to_string(i) + ".las");
        std::filesystem::copy_file(folder / "a.las", copy);
        inputs += quoted(copy) + " ";
    }
    rlimit before{}, few{};
    ::getrlimit(RLIMIT_NOFILE, &before);
    few = before;
    few.rlim_cur = 30;  // the program inherits the limit
    ::setrlimit(RLIMIT_NOFILE, &few);
    const auto outcome = lucarne("convert --normals none " + inputs + " -o " + quoted(folder / "a.luc"));
    ::setrlimit(RLIMIT_NOFILE, &before);
    EXPECT_EQ(outcome.code, 0) << outcome.text;
    EXPECT_NE(outcome.text.find("60000 points"), std::string::npos) << outcome.text;
}

TEST(ConvertFaults, RejectEveryBadSharedScanOrConvertIt) {
    const auto data = io::testing::shared_data();
    if (data.empty()) GTEST_SKIP() << "no shared scans here";
    const TempFolder folder;
    size_t files = 0;
    for (const auto& entry : std::filesystem::directory_iterator(data / "bad")) {
        const auto output = folder / (entry.path().filename().string() + ".luc");
        const auto outcome =
            lucarne("convert --normals none " + quoted(entry.path()) + " -o " + quoted(output));
        EXPECT_TRUE(outcome.code == 0 || outcome.code == 3) << entry.path() << "\n" << outcome.text;
        EXPECT_EQ(std::filesystem::exists(output), outcome.code == 0) << entry.path();
        const bool sound = outcome.code != 0 || lucarne("verify " + quoted(output)).code == 0;
        EXPECT_TRUE(sound) << entry.path();
        ++files;
    }
    EXPECT_GT(files, 10u);
}

TEST(Commands, GoOnWhereTheirProgressCannotBeWrittenAndFailWhereTheirResultCannot) {
    const TempFolder folder;
    const auto scan = quoted(folder / "a.las"), cache = quoted(folder / "a.luc");
    ASSERT_EQ(lucarne("generate cornell --even --points 50k -o " + scan).code, 0);
    // The '#' comments out the redirection of stderr that lucarne() appends.
    EXPECT_EQ(lucarne("convert --normals none " + scan + " -o " + cache + " 2>/dev/full #").code, 0);
    EXPECT_EQ(lucarne("verify " + cache).code, 0);
    const auto info = lucarne("info " + cache + " 2>&1 >/dev/full #");
    EXPECT_EQ(info.code, 1);
    EXPECT_NE(info.text.find("cannot be written"), std::string::npos) << info.text;
}

TEST(Commands, ConvertInfoVerifyAndExportWorkTogether) {
    const TempFolder folder;
    const auto scan = quoted(folder / "a.las"), cache = quoted(folder / "a.luc");
    const auto json = folder / "a.json";
    ASSERT_EQ(lucarne("generate cornell --even --points 50k -o " + scan).code, 0);
    const auto converted =
        lucarne("convert --normals none " + scan + " -o " + cache + " --json " + quoted(json));
    ASSERT_EQ(converted.code, 0) << converted.text;
    const auto report = io::testing::read_bytes(json);
    for (const char* stage : {"scan", "chunk", "build", "write", "cpu_seconds"})
        EXPECT_NE(report.find(stage), std::string::npos) << report;
    EXPECT_NE(lucarne("info " + cache).text.find("50000"), std::string::npos);
    EXPECT_NE(lucarne("info " + scan).text.find("LAS"), std::string::npos);
    EXPECT_NE(lucarne("verify " + cache).text.find("sound; 50000 points"), std::string::npos);
    EXPECT_EQ(lucarne("export " + cache + " -o " + quoted(folder / "b.las")).code, 0);
    EXPECT_EQ(std::filesystem::file_size(folder / "a.las"), std::filesystem::file_size(folder / "b.las"));
}

}  // namespace
}  // namespace lucarne
