// Tests that no command replaces its inputs.
#include <filesystem>
#include <fstream>

#include <fmt/format.h>
#include <gtest/gtest.h>

#include "tests/viewer/program.h"

namespace lucarne::viewer {
namespace {

namespace fs = std::filesystem;

class Outputs : public ::testing::Test {
 protected:
    void SetUp() override {
        ASSERT_EQ(test::lucarne("generate cornell --points 2000 -o " + scan_).code, 0);
        before_ = test::bytes_of(scan_);
    }
    /// Expects that `arguments` are refused at once and the scan stays unchanged.
    void refused(const std::string& arguments, const std::string& why = "is an input of this command") const {
        const auto done = test::lucarne(arguments);
        EXPECT_EQ(done.code, 2) << arguments << "\n" << done.output;
        EXPECT_NE(done.output.find(why), std::string::npos) << done.output;
        EXPECT_EQ(test::bytes_of(scan_), before_) << arguments;
    }

    const test::TemporaryFolder folder_;
    const std::string scan_ = folder_ / "scan.las";
    std::string before_;
};

TEST_F(Outputs, AnInputIsNeverReplacedByConvert) {
    const std::string named = folder_ / "scan";  // a scan without a scan's extension
    fs::copy_file(scan_, named);
    const std::string link = folder_ / "link.luc", twin = folder_ / "twin.luc";
    fs::create_symlink(named, link);
    fs::create_hard_link(named, twin);
    const std::string dotted = folder_ / "./scan";
    for (const auto& output : {named, link, twin, dotted}) {
        refused(fmt::format("convert {} -o {} --overwrite", named, output));
        EXPECT_EQ(test::bytes_of(named), before_) << output;
    }
    refused(fmt::format("convert {} -o {} --json {} --overwrite", scan_, folder_ / "x.luc", scan_));
    EXPECT_FALSE(fs::exists(folder_ / "x.luc"));
    // A scan in a folder that is given.
    refused(fmt::format("convert {} -o {} --json {} --overwrite", folder_.path().string(), folder_ / "x.luc",
                        scan_));
}

TEST_F(Outputs, ACacheIsNotCalledLikeAScan) {
    for (const char* name :
         {"scan.las", "new.las", "new.XYZ", "new.copc.laz", "new.txt", "new.csv", "new.obj"}) {
        const auto done = test::lucarne(fmt::format("convert {} -o {} --overwrite", scan_, folder_ / name));
        EXPECT_EQ(done.code, 2) << name << done.output;
        EXPECT_NE(done.output.find("a cache is named .luc; lucarne export writes scans"), std::string::npos)
            << done.output;
    }
    EXPECT_EQ(test::bytes_of(scan_), before_);
    EXPECT_FALSE(fs::exists(folder_ / "new.las"));
}

TEST_F(Outputs, NoOtherCommandReplacesItsInputEither) {
    refused(fmt::format("info {} --json {} --overwrite", scan_, scan_));
    refused(fmt::format("render {} --no-cache -o {} --json {} --overwrite", scan_, folder_ / "x.png", scan_));
    refused(fmt::format("measure {} --no-cache --at 0,0,0 --json {} --overwrite", scan_, scan_));
    const std::string picture = folder_ / "scan.png";
    fs::create_symlink(scan_, picture);
    refused(fmt::format("render {} --no-cache -o {} --overwrite", scan_, picture));
    refused(fmt::format("fly {} --no-cache --path none.json -o {} --overwrite", scan_, picture));
    refused(fmt::format("view {} --no-cache --screenshot {} --overwrite", scan_, picture));
    const std::string reference = folder_ / "scan.json";
    fs::create_hard_link(scan_, reference);
    refused(fmt::format("compare {} {} --json {} --overwrite", scan_, scan_, reference));
}

TEST_F(Outputs, NoOutputReplacesAnother) {
    const std::string cache = folder_ / "x.luc", dotted = folder_ / "./x.luc", link = folder_ / "link";
    fs::create_directory_symlink(folder_.path(), link);
    for (const auto& json : {cache, dotted, link + "/x.luc"})
        refused(fmt::format("convert {} -o {} --json {} --overwrite", scan_, cache, json),
                "would be written twice by this command");
    EXPECT_FALSE(fs::exists(cache));
}

TEST_F(Outputs, ACacheIsNotReplacedByItsExport) {
    const std::string cache = folder_ / "scan.luc", named = folder_ / "cache.las";
    ASSERT_EQ(test::lucarne(fmt::format("convert {} -o {} --normals none", scan_, cache)).code, 0);
    fs::rename(cache, named);
    const std::string bytes = test::bytes_of(named);
    refused(fmt::format("export {} -o {} --overwrite", named, named));
    EXPECT_EQ(test::bytes_of(named), bytes);
}

TEST_F(Outputs, ASectionDoesNotReplaceTheScanItIsOf) {
    const std::string scan = folder_ / "section-1.csv";
    std::ofstream(scan) << "x,y,z\n0,0,0\n1,1,0\n1,0,1\n0,1,1\n";
    const std::string bytes = test::bytes_of(scan), what = folder_ / "m.json";
    std::ofstream(what) << R"({"measurements": [{"kind": "section", "name": "a", "thickness": 5,
        "points": [{"position": [0, 0, 0]}, {"position": [1, 0, 0]}]}]})";
    refused(fmt::format("measure {} --no-cache --measurements {} --sections {} --overwrite", scan, what,
                        folder_.path().string()));
    EXPECT_EQ(test::bytes_of(scan), bytes);
}

}  // namespace
}  // namespace lucarne::viewer
