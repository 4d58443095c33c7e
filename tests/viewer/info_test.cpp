// `lucarne info` says what a scan file holds.
#include <gmock/gmock.h>
#include <nlohmann/json.hpp>

#include "tests/viewer/program.h"

namespace lucarne::test {
namespace {

TEST(InfoCommand, ListsTheScansAndStationsOfAnE57File) {
    const TemporaryFolder folder;
    const std::string json_file = folder / "info.json";
    const auto outcome = lucarne("info " LUCARNE_SOURCE_DIR "/tests/io/e57_posed.e57 --json " + json_file);
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

}  // namespace
}  // namespace lucarne::test
