// Tests that `export` writes the converted points to LAS, LAZ and COPC.
#include <algorithm>
#include <fstream>
#include <vector>

#include <fmt/format.h>
#include <gtest/gtest.h>

#include "tests/viewer/program.h"

namespace lucarne::viewer {
namespace {

class ExportCommand : public ::testing::Test {
 protected:
    /// Converts; expects success. Returns the output.
    std::string convert(const std::string& inputs, const std::string& cache,
                        const std::string& options = "") const {
        return succeed(
            fmt::format("convert {} -o {} --overwrite --normals none {}", inputs, folder_ / cache, options));
    }
    std::string write(const std::string& cache, const std::string& output) const {
        return succeed(fmt::format("export {} -o {} --overwrite", folder_ / cache, folder_ / output));
    }
    static std::string succeed(const std::string& command) {
        const auto done = test::lucarne(command);
        EXPECT_EQ(done.code, 0) << command << "\n" << done.output;
        return done.output;
    }
    std::string text(const std::string& name, const std::string& lines) const {
        std::ofstream(folder_ / name) << lines;
        return folder_ / name;
    }
    /// Returns the positions of a scan as text, sorted.
    std::vector<std::string> positions(const std::string& scan) const {
        convert(folder_ / scan, "again.luc");
        write("again.luc", "again.csv");
        return lines(folder_ / "again.csv", ',');
    }
    static std::vector<std::string> lines(const std::string& path, char separator) {
        std::vector<std::string> all;
        std::ifstream in(path);
        for (std::string line; std::getline(in, line);) {
            if (line.empty() || line[0] == '#' || line[0] == 'x') continue;
            size_t end = 0;  // behind the third number
            for (int i = 0; i < 3 && end != line.npos; ++i) end = line.find(separator, end + (i > 0));
            line = line.substr(0, end);
            std::replace(line.begin(), line.end(), separator, ' ');
            all.push_back(line);
        }
        std::sort(all.begin(), all.end());
        return all;
    }

    const test::TemporaryFolder folder_;
};

TEST_F(ExportCommand, CoordinatesOfLargeGridsComeThroughToTheLastDigit) {
    const std::string utm =
        text("utm.xyz", "500000.123 5400000.456 100.789\n500100.001 5400250.250 99.999\n");
    convert(utm, "utm.luc");
    for (const std::string output : {"utm.las", "utm.laz", "utm.copc.laz"}) {
        const auto said = write("utm.luc", output);
        EXPECT_EQ(said.find("rounded"), said.npos) << said;
        EXPECT_EQ(positions(output), lines(utm, ' ')) << output;
    }
}

TEST_F(ExportCommand, TilesOfOtherScalesAndOffsetsKeepEveryDigitTogetherAndWhenAppended) {
    // Two LAS files: of 3 decimals around one place, of 4 around another.
    convert(text("a.xyz", "7650000.123 650000.456 300.789\n7650010.001 650020.250 299.999\n"), "a.luc");
    convert(text("b.xyz", "7651000.1234 650100.4567 10.7891\n7651010.0001 650120.2501 29.9999\n"), "b.luc");
    write("a.luc", "a.las");
    write("b.luc", "b.laz");
    std::vector<std::string> all = positions("b.laz");
    for (const std::string& line : positions("a.las")) {
        std::string four;  // a has one digit less
        for (const char c : line + " ") four += c == ' ' ? std::string("0 ") : std::string(1, c);
        all.push_back(four.substr(0, four.size() - 1));
    }
    std::sort(all.begin(), all.end());
    const std::string a = folder_ / "a.las", b = folder_ / "b.laz";
    convert(a + " " + b, "both.luc");
    write("both.luc", "both.laz");
    EXPECT_EQ(positions("both.laz"), all);
    convert(a, "grown.luc");
    succeed(fmt::format("convert {} --append -o {}", b, folder_ / "grown.luc"));
    write("grown.luc", "grown.copc.laz");
    EXPECT_EQ(positions("grown.copc.laz"), all);
}

TEST_F(ExportCommand, WhatIntegersCannotHoldIsRoundedAndSaid) {
    convert(text("fine.xyz", "0.123456789012345 1 2\n1000 2000 3000\n"), "fine.luc");
    const auto said = write("fine.luc", "fine.laz");
    EXPECT_NE(said.find("coordinates are rounded, by at most 2.1e-07"), said.npos) << said;
}

TEST_F(ExportCommand, WritesWhatClipsAndClassesLeave) {
    std::string lines = "x y z classification\n";
    for (int x = 0; x < 10; ++x)
        for (int y = 0; y < 10; ++y) lines += fmt::format("{} {} 0 {}\n", x, y, x < 5 ? 2 : 6);
    convert(text("grid.xyz", lines), "grid.luc");
    const auto count = [&](const std::string& options) {
        succeed(fmt::format("export {} -o {} --overwrite {}", folder_ / "grid.luc", folder_ / "part.csv",
                            options));
        return this->lines(folder_ / "part.csv", ',').size();
    };
    EXPECT_EQ(count(""), 100u);
    EXPECT_EQ(count("--clip-box 2,2,-1,4,6,1"), 15u) << "faces included";
    EXPECT_EQ(count("--clip-outside 2,2,-1,4,6,1"), 85u);
    EXPECT_EQ(count("--clip-plane 6,0,0,1,0,0"), 40u);
    EXPECT_EQ(count("--clip-box 0,0,0,0,9,0 --clip-box 9,0,0,9,9,0"), 20u);
    EXPECT_EQ(count("--hide-class 6"), 50u);
    EXPECT_EQ(count("--keep-class 6 --clip-plane 6,0,0,1,0,0"), 40u);
    EXPECT_EQ(count("--keep-class 6 --hide-class 6"), 0u);
    EXPECT_EQ(count("--every 10"), 10u);
    // A saved scene hides the same points.
    std::ofstream(folder_ / "scene.json")
        << R"({"look": {"hidden_classes": [2], "clip": {"boxes": [{"min": [0, 0, -1], "max": [5, 9, 1]}]}}})";
    EXPECT_EQ(count("--scene " + folder_ / "scene.json"), 10u);

    const auto refused = test::lucarne(
        fmt::format("export {} -o {} --attributes clasification", folder_ / "grid.luc", folder_ / "no.csv"));
    EXPECT_EQ(refused.code, 2);
    EXPECT_NE(refused.output.find("did you mean classification"), std::string::npos) << refused.output;
    EXPECT_EQ(refused.output.find("exporting"), std::string::npos) << "no progress before an error";
    EXPECT_FALSE(std::filesystem::exists(folder_ / "no.csv"));
    const auto unknown =
        test::lucarne(fmt::format("export {} -o {}", folder_ / "grid.luc", folder_ / "no.foo"));
    EXPECT_NE(unknown.code, 0);
    EXPECT_EQ(unknown.output.find("exporting"), std::string::npos) << unknown.output;
}

TEST_F(ExportCommand, AttributesThatAreLeftOutTakeNoSpaceInLasEither) {
    const std::string cache = test::make_cornell(folder_, "2k"), output = folder_ / "part.las";
    succeed(fmt::format("export {} -o {} --attributes intensity", cache, output));
    const auto info = test::lucarne("info " + output);
    EXPECT_NE(info.output.find("intensity"), std::string::npos);
    EXPECT_EQ(info.output.find("\"color\""), std::string::npos) << info.output;
}

}  // namespace
}  // namespace lucarne::viewer
