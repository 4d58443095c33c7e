// Many inputs at once: folders, and broken files among good ones.
#include <array>
#include <filesystem>
#include <fstream>
#include <utility>

#include <fcntl.h>
#include <fmt/format.h>
#include <gtest/gtest.h>
#include <nlohmann/json.hpp>
#include <sys/stat.h>

#include "octree/cache/cache.h"
#include "tests/viewer/program.h"

namespace lucarne::viewer {
namespace {

namespace fs = std::filesystem;

class ConvertInputs : public ::testing::Test {
 protected:
    void SetUp() override {
        fs::create_directories(scans_ / "below");
        for (int i = 0; i < 3; ++i)
            ASSERT_EQ(
                test::lucarne(fmt::format("generate cornell --points 3000 --seed {} -o {}", i, scan(i))).code,
                0);
        std::ofstream(scans_ / "notes.md") << "not a scan";
    }
    std::string scan(int i) const {
        return (scans_ / (i == 2 ? "below" : "") / fmt::format("scan{}.las", i)).string();
    }
    test::Outcome convert(const std::string& what) const {
        return test::lucarne("convert -o " + cache_ + " " + what);
    }
    std::string cached() const {
        const std::string cache = folder_ / "small.luc";
        if (!fs::exists(cache)) test::lucarne(fmt::format("convert {} -o {} --normals none", scan(0), cache));
        return cache;
    }
    void cut_short(int i) const { fs::resize_file(scan(i), fs::file_size(scan(i)) / 2); }

    const test::TemporaryFolder folder_;
    const fs::path scans_ = folder_ / "scans";
    const std::string cache_ = folder_ / "all.luc";
};

TEST_F(ConvertInputs, AFolderStandsForTheScansInItAndBelow) {
    const auto done = convert(scans_.string() + " --normals none");
    ASSERT_EQ(done.code, 0) << done.output;
    EXPECT_EQ(octree::open_cache(cache_).value()->header().scans.size(), 3u);
}

TEST_F(ConvertInputs, ABrokenFileOfManyStopsOnlyItselfAndIsNamed) {
    cut_short(1);
    const auto done = convert(scans_.string() + " --normals none");
    EXPECT_EQ(done.code, 3) << done.output;
    EXPECT_NE(done.output.find("1 of 3 inputs are not in it"), std::string::npos) << done.output;
    EXPECT_NE(done.output.find(scan(1) + ": is truncated"), std::string::npos) << done.output;
    const auto cache = octree::open_cache(cache_);
    ASSERT_TRUE(cache) << cache.error().line();
    EXPECT_EQ((*cache)->header().scans.size(), 2u);
}

TEST_F(ConvertInputs, ABrokenFileAloneAndAFolderOfNoneFail) {
    cut_short(0);
    EXPECT_EQ(convert(scan(0)).code, 3);
    EXPECT_FALSE(fs::exists(cache_));
    fs::create_directories(folder_ / "empty");
    EXPECT_EQ(convert(folder_ / "empty").code, 3);
    for (int i = 1; i < 3; ++i) cut_short(i);
    EXPECT_EQ(convert(scans_.string()).code, 3);
    EXPECT_FALSE(fs::exists(cache_));
}

TEST_F(ConvertInputs, AFolderHoldsTextAndMeshesAndSaysWhatElse) {
    const fs::path folder = folder_ / "mixed";
    fs::create_directories(folder);
    for (const char* name : {"a.csv", "b.txt", "c.xyz"})
        ASSERT_EQ(test::lucarne(fmt::format("export {} -o {}", cached(), (folder / name).string())).code, 0);
    std::ofstream(folder / "mesh.OBJ") << "v 0 0 0\nv 1 0 0\nv 0 1 0\nf 1 2 3\n";
    std::ofstream(folder / "LICENCE.txt") << "A licence\n1. You may copy 2 3 4\n";
    std::ofstream(folder / "photo.jpg") << "\xff\xd8\xff";
    const std::string json = folder_ / "info.json";
    const auto done = test::lucarne(fmt::format("info --quick {} --json {}", folder.string(), json));
    EXPECT_EQ(done.code, 0) << done.output;
    const auto listed = nlohmann::json::parse(test::bytes_of(json));
    ASSERT_EQ(listed.size(), 4u);
    for (size_t i = 0; i < 4; ++i)
        EXPECT_EQ(listed[i]["path"],
                  (folder / std::array{"a.csv", "b.txt", "c.xyz", "mesh.OBJ"}[i]).string());
    EXPECT_NE(done.output.find("2 other files are skipped: LICENCE.txt, photo.jpg\n"), std::string::npos)
        << done.output;
}

TEST_F(ConvertInputs, WhatAFolderNamesAndCannotGiveIsNamed) {
    fs::create_symlink("nowhere.las", scans_ / "dangling.las");
    ASSERT_EQ(test::shell("mkfifo " + (scans_ / "pipe.e57").string()).code, 0);
    const auto done = convert(scans_.string() + " --normals none");
    EXPECT_EQ(done.code, 3) << done.output;
    EXPECT_NE(done.output.find("2 of 5 inputs are not in it: "), std::string::npos) << done.output;
    EXPECT_NE(done.output.find("dangling.las: cannot be opened"), std::string::npos) << done.output;
    EXPECT_NE(done.output.find("pipe.e57: is not a regular file"), std::string::npos) << done.output;
}

TEST_F(ConvertInputs, AFolderWithoutScansAndAnUnreadableOneStopOnlyThemselves) {
    fs::create_directories(folder_ / "empty");
    const auto done = convert(fmt::format("{} {} --normals none", folder_ / "empty", scan(0)));
    EXPECT_EQ(done.code, 3) << done.output;
    EXPECT_NE(done.output.find("1 of 2 inputs are not in it: " + (folder_ / "empty") + "\n"),
              std::string::npos)
        << done.output;
    EXPECT_TRUE(fs::exists(cache_));
    // Too deep for the full path to be opened, whoever runs the test.
    int deepest = open(scans_.c_str(), O_DIRECTORY);
    for (int i = 0; i < 30; ++i) {
        const std::string step(200, 'd');
        ASSERT_EQ(mkdirat(deepest, step.c_str(), 0777), 0);
        const int below = openat(deepest, step.c_str(), O_DIRECTORY);
        close(std::exchange(deepest, below));
    }
    close(deepest);
    const auto info = test::lucarne("info --quick " + scans_.string());
    EXPECT_EQ(info.code, 3);
    EXPECT_NE(info.output.find("cannot be searched: File name too long"), std::string::npos) << info.output;
    EXPECT_NE(info.output.find("1 of 4 inputs cannot be read"), std::string::npos) << info.output;
}

TEST_F(ConvertInputs, AFileThatIsGivenTwiceIsTakenOnce) {
    fs::create_hard_link(scan(0), scans_ / "twin.las");
    fs::create_symlink(scan(1), scans_ / "link.las");
    const auto done = convert(fmt::format("{} {} {} --normals none", scan(0), scan(0), scans_.string()));
    EXPECT_EQ(done.code, 0) << done.output;
    EXPECT_NE(done.output.find(scan(0) + ": was given twice; it is taken once"), std::string::npos)
        << done.output;
    EXPECT_NE(done.output.find("twin.las: is the same file as " + scan(0)), std::string::npos) << done.output;
    const auto cache = octree::open_cache(cache_);
    ASSERT_TRUE(cache);
    EXPECT_EQ((*cache)->header().scans.size(), 3u);
}

TEST_F(ConvertInputs, AWarningIsSaidOnceHoweverOftenAFileIsOpened) {
    std::fstream file(scan(0), std::ios::in | std::ios::out | std::ios::binary);
    file.seekp(100).put('\x63');  // 99 variable length records
    file.close();
    const auto done = convert(scans_.string() + " --normals none");
    EXPECT_EQ(done.code, 0) << done.output;
    const size_t first = done.output.find(" records promised, ");
    ASSERT_NE(first, std::string::npos) << done.output;
    EXPECT_EQ(done.output.find(" records promised, ", first + 1), std::string::npos) << done.output;
}

TEST_F(ConvertInputs, WhatIsRefusedIsNamed) {
    const auto nameless = test::lucarne("info ''");
    EXPECT_EQ(nameless.code, 3);
    EXPECT_NE(nameless.output.find("'': is not a file name"), std::string::npos) << nameless.output;
    const auto raw = test::lucarne(fmt::format("export {} -o {}", scan(0), folder_ / "x.las"));
    EXPECT_EQ(raw.code, 3);
    EXPECT_NE(raw.output.find(scan(0) + ": is not a Lucarne cache; if it is a scan, convert it first"),
              std::string::npos)
        << raw.output;
    std::ofstream(folder_ / "short.luc") << "x";
    EXPECT_NE(test::lucarne("verify " + (folder_ / "short.luc")).output.find("is not a Lucarne cache"),
              std::string::npos);
    EXPECT_NE(
        test::lucarne(fmt::format("export {} -o {}", cached(), folder_ / "x.foo")).output.find(".copc.laz"),
        std::string::npos);
}

TEST_F(ConvertInputs, InfoPrintsCoordinatesAsTheFileHasThemAndSaysWhichUnitIsAssumed) {
    const std::string rows = folder_ / "rows.xyz";
    std::ofstream(rows) << "636000.1 848935.2 0.3\n636000.3 848935.3 0.4\n";
    const auto text = test::shell(LUCARNE_BINARY " info " + rows + " 2> " + (folder_ / "messages")).output;
    EXPECT_NE(text.find("636000.1 848935.2 0.3\n"), std::string::npos) << text;
    EXPECT_NE(text.find("m (assumed)\n"), std::string::npos) << text;
    EXPECT_EQ(test::lucarne("info --unit m " + rows).output.find("(assumed)"), std::string::npos);
}

TEST_F(ConvertInputs, TheReportListsWhatWasRejected) {
    cut_short(1);
    const std::string json = folder_ / "report.json";
    EXPECT_EQ(convert(scans_.string() + " --normals none --json " + json).code, 3);
    auto report = nlohmann::json::parse(test::bytes_of(json));
    ASSERT_EQ(report["rejected"].size(), 1u);
    EXPECT_EQ(report["rejected"][0]["path"], scan(1));
    EXPECT_NE(report["rejected"][0]["reason"].get<std::string>().find("is truncated"), std::string::npos);
    EXPECT_EQ(report["inputs"].size(), 2u);
    EXPECT_EQ(test::lucarne(fmt::format("info {} --overwrite --json {}", scans_.string(), json)).code, 3);
    report = nlohmann::json::parse(test::bytes_of(json));
    ASSERT_EQ(report.size(), 3u);
    EXPECT_EQ(report[2]["kind"], "rejected");
    EXPECT_EQ(report[2]["path"], scan(1));
}

}  // namespace
}  // namespace lucarne::viewer
