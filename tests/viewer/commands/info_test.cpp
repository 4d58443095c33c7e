// Tests that `lucarne info` shows what a scan file contains.
#include <fstream>

#include <gmock/gmock.h>
#include <nlohmann/json.hpp>

#include "tests/viewer/program.h"

namespace lucarne::test {
namespace {

TEST(InfoCommand, ListsTheScansAndStationsOfAnE57File) {
    const TemporaryFolder folder;
    const std::string json_file = folder / "info.json";
    const auto outcome =
        lucarne("info " LUCARNE_SOURCE_DIR "/tests/io/formats/e57/posed.e57 --json " + json_file);
    ASSERT_EQ(outcome.code, 0) << outcome.output;
    EXPECT_THAT(outcome.output, testing::HasSubstr("E57 1.0, 3 scans, 0 images"));
    std::ifstream in(json_file);
    const auto info = nlohmann::json::parse(in);
    EXPECT_EQ(info["declared_points"], 690);
    ASSERT_EQ(info["stations"].size(), 3u);
    EXPECT_EQ(info["stations"][0], (nlohmann::json{{"id", 1}, {"position", {600000.25, 200000.5, 400.125}}}));
    ASSERT_EQ(info["scans"].size(), 3u);
    EXPECT_EQ(info["scans"][1]["name"], "posed 250");
    EXPECT_TRUE(info["images"].empty());
}

TEST(InfoCommand, WritesNoControlCharacterOfAFileOrItsNameToTheTerminal) {
    const TemporaryFolder folder;
    const std::string hostile =
        "\x1b]0;title\x07 \xc2\x9b"
        "2J \xff";
    const auto is_clean = [](const std::string& output) {
        for (size_t i = 0; i < output.size(); ++i) {
            const auto byte = static_cast<unsigned char>(output[i]);
            const bool eight_bits = byte == 0xc2 && i + 1 < output.size() && (output[i + 1] & 0xe0) == 0x80;
            if ((byte < 0x20 && byte != '\n') || byte == 0x7f || byte == 0xff || eight_bits) return false;
        }
        return true;
    };
    const std::string ply = folder / (hostile + ".ply"), cut = folder / (hostile + "cut.ply"),
                      xyz = folder / (hostile + ".xyz");
    const std::string head = "ply\nformat ascii 1.0\ncomment " + hostile +
                             "\nelement vertex 2\nproperty float x\n"
                             "property float y\nproperty float z\nproperty float " +
                             hostile + "q\nend_header\n";
    std::ofstream(ply) << "ply\nformat ascii 1.0\nelement vertex 1\nproperty float x\nproperty float y\n"
                          "property float z\nproperty float \x1bq\nend_header\n1 2 3 4\n";
    std::ofstream(cut) << head << "1 2 3";
    std::ofstream(xyz) << "x y z \x1b[2J\n1 2 3 4\n5 6 7 8\n";
    for (const std::string& path : {ply, cut, xyz, folder / (hostile + "missing")}) {
        const auto outcome = lucarne("info '" + path + "'");
        EXPECT_TRUE(is_clean(outcome.output)) << ::testing::PrintToString(outcome.output);
    }
    const auto both = lucarne("info '" + ply + "' '" + cut + "' '" + xyz + "'");
    EXPECT_TRUE(is_clean(both.output)) << ::testing::PrintToString(both.output);
    const std::string cache = folder / (hostile + ".luc");
    ASSERT_EQ(lucarne("convert '" + ply + "' -o '" + cache + "'").code, 0);
    for (const char* command : {"info", "verify"})
        EXPECT_TRUE(is_clean(lucarne(command + (" '" + cache + "'")).output)) << command;
}

/// Returns one number of `lucarne info`'s output for a file.
double info_number(const TemporaryFolder& folder, const std::string& arguments, const std::string& key) {
    const std::string json_file = folder / "number.json";
    const auto outcome = lucarne("info " + arguments + " --overwrite --json " + json_file);
    EXPECT_EQ(outcome.code, 0) << outcome.output;
    std::ifstream in(json_file);
    const auto value = nlohmann::json::parse(in).value(key, nlohmann::json(-1.0));
    return value.is_boolean() ? value.get<bool>() : value.get<double>();
}

/// Returns the whole output of `lucarne info` for a file.
nlohmann::json info_of(const TemporaryFolder& folder, const std::string& arguments) {
    const std::string json_file = folder / "all.json";
    const auto outcome = lucarne("info " + arguments + " --overwrite --json " + json_file);
    EXPECT_EQ(outcome.code, 0) << outcome.output;
    std::ifstream in(json_file);
    return nlohmann::json::parse(in);
}

TEST(InfoCommand, SaysWhatAMeshHoldsWithoutSamplingIt) {
    const TemporaryFolder folder;
    const std::string obj = folder / "square.obj", ply = folder / "square.ply";
    std::ofstream(obj) << "v 0 0 0\nv 100 0 0\nv 100 100 5\nv 0 100 5\nv 999 0 0\nf 1 2 3 4\n";
    std::ofstream(ply)
        << "ply\nformat ascii 1.0\nelement vertex 4\nproperty float x\nproperty float y\n"
           "property float z\nelement face 1\nproperty list uchar int vertex_indices\nend_header\n"
           "0 0 0\n100 0 0\n100 100 5\n0 100 5\n4 0 1 2 3\n";
    for (const std::string& path : {obj, ply}) {
        const auto info = info_of(folder, path + " --mesh-points 1G");  // sampling them would take minutes
        EXPECT_FALSE(info.contains("points"));
        EXPECT_NEAR(info["expected_points"].get<double>(), 1e9, 1e6);
        EXPECT_EQ(info["min"], nlohmann::json({0.0, 0.0, 0.0}));
        EXPECT_EQ(info["max"], nlohmann::json({100.0, 100.0, 5.0}));
        EXPECT_EQ(info["mesh"]["faces"], 1);
        EXPECT_EQ(info["mesh"]["triangles"], 2);
        EXPECT_NEAR(info["mesh"]["area_m2"].get<double>(), 10012.5, 0.1);
    }
}

TEST(InfoCommand, TellsTheBoxOfThePointsFromTheOneThatAHeaderStates) {
    const TemporaryFolder folder;
    const std::string las = folder / "cornell.las", cache = folder / "cornell.luc",
                      copc = folder / "cornell.copc.laz", laz = folder / "cornell.laz";
    ASSERT_EQ(lucarne("generate cornell --points 2k -o " + las).code, 0);
    ASSERT_EQ(lucarne("convert " + las + " -o " + cache).code, 0);
    ASSERT_EQ(lucarne("export " + cache + " -o " + copc).code, 0);
    ASSERT_EQ(lucarne("export " + cache + " -o " + laz).code, 0);
    for (const std::string& path : {las, laz, copc}) {
        std::fstream file(path, std::ios::in | std::ios::out | std::ios::binary);
        const double lie = 1.25;
        file.seekp(179);  // the largest x
        file.write(reinterpret_cast<const char*>(&lie), sizeof lie);
        file.close();
        const auto info = info_of(folder, path);
        EXPECT_GT(info["max"][0].get<double>(), 1.3) << path;
        EXPECT_EQ(info["stated_max"][0], lie) << path;
        const auto quick = info_of(folder, path + " --quick");
        EXPECT_FALSE(quick.contains("max")) << path;
        EXPECT_EQ(quick["stated_max"][0], lie) << path;
    }
}

TEST(UnitOption, IsTheUnitOfFilesOfEveryFormatAndOfTheCachesMadeOfThem) {
    const TemporaryFolder folder;
    const std::vector<std::pair<std::string, std::string>> files = {
        {"a.xyz", "1 2 3\n4 5 6\n"},
        {"a.pts", "2\n1 2 3 0 9 9 9\n4 5 6 0 9 9 9\n"},
        {"a.ptx", "1\n1\n0 0 0\n1 0 0\n0 1 0\n0 0 1\n1 0 0 0\n0 1 0 0\n0 0 1 0\n0 0 0 1\n1 2 3 0.5\n"},
        {"a.pcd",
         "VERSION 0.7\nFIELDS x y z\nSIZE 4 4 4\nTYPE F F F\nCOUNT 1 1 1\nWIDTH 1\nHEIGHT 1\nPOINTS 1\nDATA "
         "ascii\n1 2 3\n"},
        {"a.ply",
         "ply\nformat ascii 1.0\nelement vertex 1\nproperty float x\nproperty float y\nproperty float "
         "z\nend_header\n1 2 3\n"},
        {"a.obj", "v 0 0 0\nv 1 0 0\nv 0 1 0\nf 1 2 3\n"}};
    std::vector<std::string> paths = {LUCARNE_SOURCE_DIR "/tests/io/formats/e57/posed.e57"};
    for (const auto& [name, text] : files) {
        std::ofstream(folder / name) << text;
        paths.push_back(folder / name);
    }
    paths.push_back(folder / "cornell.las");
    ASSERT_EQ(lucarne("generate cornell --points 1k -o " + paths.back()).code, 0);
    for (const std::string& path : paths) {
        EXPECT_EQ(info_number(folder, path, "metres_per_unit"), 1) << path;
        const bool format_states_it = path.ends_with(".e57") || path.ends_with(".ptx");
        EXPECT_EQ(info_number(folder, path, "unit_stated"), format_states_it) << path;
        EXPECT_EQ(info_number(folder, path + " --unit m", "unit_stated"), 1) << path;
        EXPECT_DOUBLE_EQ(info_number(folder, path + " --unit us-ft", "metres_per_unit"), 1200.0 / 3937)
            << path;
    }
    const std::string cache = folder / "a.luc";
    ASSERT_EQ(lucarne("convert " + paths.back() + " --unit 0.25 -o " + cache).code, 0);
    EXPECT_EQ(info_number(folder, cache, "metres_per_unit"), .25);
    for (const char* none : {"mile", "0", "-1", "nan", "1e300"})
        EXPECT_EQ(lucarne("info " + paths.back() + " --unit=" + none).code, 2) << none;
}

TEST(UnitOption, AMeshIsSampledByMetresOfItsUnit) {
    const TemporaryFolder folder;
    const std::string mesh = folder / "square.obj";
    std::ofstream(mesh) << "v 0 0 0\nv 100 0 0\nv 100 100 0\nv 0 100 0\nf 1 2 3 4\n";  // a square metre in cm
    ASSERT_EQ(lucarne("convert " + mesh + " --unit cm --spacing 0.02 -o " + (folder / "a.luc")).code, 0);
    // Blue noise of a mean distance d has about 1 / d^2 points an area.
    EXPECT_NEAR(info_number(folder, folder / "a.luc", "points"), 2500, 1000);
}

}  // namespace
}  // namespace lucarne::test
