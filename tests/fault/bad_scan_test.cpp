// The program on bad scans: exit code 3, one line that names the file and the reason, no files left behind.
#include <gmock/gmock.h>

#include "tests/fault/run_lucarne.h"
#include "tests/io/formats/las/las_builder.h"
#include "tests/io/io_testing.h"

namespace lucarne {
namespace {

using io::testing::TemporaryFolder;
using io::testing::write_bytes;
using test::lucarne;
using test::quoted;
using ::testing::HasSubstr;

/// Returns the last line of the output; warnings may precede it.
std::string last_line(const std::string& text) {
    const size_t end = text.find_last_not_of('\n');
    const size_t before = text.find_last_of('\n', end);
    return text.substr(before == text.npos ? 0 : before + 1, end - before);
}

void expect_rejected(const std::filesystem::path& file, const std::string& reason) {
    const TemporaryFolder folder;
    for (const std::string& command :
         {"info " + quoted(file), "convert " + quoted(file) + " -o " + quoted(folder / "a.luc")}) {
        const auto outcome = lucarne(command);
        EXPECT_EQ(outcome.code, 3) << command << '\n' << outcome.text;
        EXPECT_THAT(last_line(outcome.text), HasSubstr("lucarne: " + file.string() + ": "));
        EXPECT_THAT(last_line(outcome.text), HasSubstr(reason));
    }
    EXPECT_TRUE(std::filesystem::is_empty(folder.path())) << file;
}

TEST(BadScan, FilesThatAreNotWhatTheySayAreRejectedByEveryCommand) {
    const TemporaryFolder folder;
    io::testing::LasFile las;
    las.records = {io::testing::record0(1, 2, 3), io::testing::record0(4, 5, 6)};
    const std::string good = las.bytes();
    las.said_old_points = 4'000'000'000;
    const std::vector<std::pair<std::string, std::string>> files = {
        {"", "is empty"},
        {"What is this?", "is named .las and has no such header"},
        {good.substr(0, 200), "ends inside its LAS header"},
        {good.substr(0, good.size() - 1), "is truncated: its header promises"},
        {las.bytes(), "promises 4000000000 points"},
        {"ply\nformat ascii 1.0\nelement vertex 5\nproperty float x\nproperty float y\nend_header\n1 2\n",
         "promises 5 points"}};
    for (const auto& [bytes, reason] : files) {
        write_bytes(folder / "scan.las", bytes);
        expect_rejected(folder / "scan.las", reason);
    }
    expect_rejected(folder / "missing.las", "cannot be opened");
}

TEST(BadScan, WhatIsFoundOnlyWhileReadingIsRejectedAsWell) {
    const TemporaryFolder folder;
    write_bytes(folder / "scan.ply",
                "ply\nformat ascii 1.0\nelement vertex 2\nproperty float x\nproperty float y\nproperty float "
                "z\nend_header\n1 2 3\n4 five 6\n");
    const auto outcome =
        lucarne("convert " + quoted(folder / "scan.ply") + " -o " + quoted(folder / "a.luc"));
    EXPECT_EQ(outcome.code, 3) << outcome.text;
    EXPECT_THAT(last_line(outcome.text), HasSubstr("vertex 2 has 'five'"));
    EXPECT_FALSE(std::filesystem::exists(folder / "a.luc"));
}

TEST(BadScan, TheBadLasAndPlyFilesOfTheSharedDataAreRejectedOrConverted) {
    const auto shared = io::testing::shared_data();
    if (shared.empty()) GTEST_SKIP() << "the shared data is not here";
    expect_rejected(shared / "bad/pdal_garbage_nVariableLength.las", "is truncated: its header promises");
    expect_rejected(shared / "bad/pdal_no_vertex.ply", "no vertex element");
    const TemporaryFolder folder;
    for (const char* name : {"pdal_bad_vlr_count.las", "pdal_gps-time-nan.las"}) {
        const auto cache = folder / (std::string(name) + ".luc");
        const auto converted = lucarne("convert " + quoted(shared / "bad" / name) + " -o " + quoted(cache));
        EXPECT_EQ(converted.code, 0) << name << '\n' << converted.text;
        EXPECT_EQ(lucarne("verify " + quoted(cache)).code, 0) << name;
    }
}

}  // namespace
}  // namespace lucarne
