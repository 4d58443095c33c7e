#include <algorithm>
#include <cmath>
#include <filesystem>
#include <fstream>
#include <string>

#include <gmock/gmock.h>
#include <gtest/gtest.h>
#include <nlohmann/json.hpp>

#include "io/formats/scan.h"
#include "io/synthetic/synthetic.h"
#include "tests/viewer/program.h"

namespace lucarne {
namespace {

using testing::HasSubstr;

using test::lucarne;

class GenerateCommand : public testing::Test {
 protected:
    std::string path(const std::string& name) const { return folder_ / name; }
    test::TemporaryFolder folder_;
};

TEST_F(GenerateCommand, WritesTheScanWithItsStations) {
    ASSERT_EQ(lucarne("generate cornell -o " + path("a.las") + " --points 0.02M --stations 2").code, 0);
    const auto scan = io::open_scan(path("a.las"));
    ASSERT_TRUE(scan) << scan.error().line();
    EXPECT_NEAR(static_cast<double>((*scan)->info().declared_points), 20'000, 1000);
    io::SyntheticOptions options;
    options.stations = 2;
    const auto expected = io::synthetic_source(options).value()->info().stations;
    const auto& stations = (*scan)->info().stations;
    ASSERT_EQ(stations.size(), expected.size());
    for (size_t i = 0; i < stations.size(); ++i) {
        EXPECT_EQ(stations[i].id, expected[i].id);
        EXPECT_EQ(stations[i].position, expected[i].position);
    }
}

TEST_F(GenerateCommand, EvenPlyHoldsExactlyThePointsOfTheStream) {
    ASSERT_EQ(lucarne("generate statue -o " + path("a.ply") + " --points 5k --even --normals").code, 0);
    const auto scan = io::open_scan(path("a.ply")).value();
    io::SyntheticOptions options;
    options.scene = "statue";
    options.points = 5000;
    options.even = options.normals = true;
    const auto source = io::synthetic_source(options).value();
    const auto reader = scan->open().value(), truth = source->open().value();
    io::PointBatch got, expected;
    ASSERT_EQ(reader->read(got, 10'000).value(), 5000u);
    ASSERT_EQ(truth->read(expected, 10'000).value(), 5000u);
    const auto* normal = scan->schema().find(io::names::normal);
    const auto* true_normal = source->schema().find(io::names::normal);
    ASSERT_NE(normal, nullptr);
    for (size_t i = 0; i < 5000; ++i) {
        const std::byte* a = got.bytes.data() + i * scan->schema().stride;
        const std::byte* b = expected.bytes.data() + i * source->schema().stride;
        const glm::dvec3 off = io::position_of(scan->schema(), a) - io::position_of(source->schema(), b);
        EXPECT_LT(std::abs(off.x) + std::abs(off.y) + std::abs(off.z), 1e-5);
        EXPECT_EQ(io::load<float>(a + normal->offset), io::load<float>(b + true_normal->offset));
    }
}

TEST_F(GenerateCommand, TheSameSeedGivesTheSameFile) {
    for (const std::string name : {"a.las", "b.las"})
        ASSERT_EQ(lucarne("generate two-rooms -o " + path(name) + " --points 30k --seed 7").code, 0);
    ASSERT_EQ(lucarne("generate two-rooms -o " + path("c.las") + " --points 30k --seed 8").code, 0);
    EXPECT_EQ(test::bytes_of(path("a.las")), test::bytes_of(path("b.las")));
    EXPECT_NE(test::bytes_of(path("a.las")), test::bytes_of(path("c.las")));
}

TEST_F(GenerateCommand, AnUnknownSceneIsAnsweredWithThoseThereAre) {
    const auto outcome = lucarne("generate moon -o " + path("a.las"));
    EXPECT_EQ(outcome.code, 2);
    for (const auto& scene : io::synthetic_scenes()) EXPECT_THAT(outcome.output, HasSubstr(scene.name));
    EXPECT_FALSE(std::filesystem::exists(path("a.las")));
    const auto help = lucarne("generate --help");
    EXPECT_EQ(help.code, 0);
    for (const auto& scene : io::synthetic_scenes()) EXPECT_THAT(help.output, HasSubstr(scene.summary));
}

TEST_F(GenerateCommand, BadArgumentsLeaveNothingBehind) {
    for (const std::string bad : {"--points 5Q", "--points -3", "--points 0", "--noise -1", "--noise nan",
                                  "--stations 2000", "--stations x", "--even --stations 2", "--seed x"}) {
        const auto outcome = lucarne("generate cornell -o " + path("a.las") + " " + bad);
        EXPECT_EQ(outcome.code, 2) << bad << ": " << outcome.output;
        EXPECT_EQ(std::count(outcome.output.begin(), outcome.output.end(), '\n'), 1) << outcome.output;
        EXPECT_TRUE(std::filesystem::is_empty(folder_.path())) << bad;
    }
    EXPECT_EQ(lucarne("generate cornell -o " + path("a.zyx")).code, 2);
    EXPECT_EQ(lucarne("generate cornell").code, 2);
    EXPECT_EQ(lucarne("generate cornell -o " + path("missing/a.las")).code, 1);
}

TEST_F(GenerateCommand, WritesTheSurfaceAloneOrBesideTheScan) {
    ASSERT_EQ(lucarne("generate cornell --mesh " + path("alone.ply")).code, 0);
    EXPECT_EQ(std::distance(std::filesystem::directory_iterator(folder_.path()), {}), 1);
    ASSERT_EQ(lucarne("generate cornell --points 1000 -o " + path("a.las") + " --mesh " + path("a.ply")).code,
              0);
    EXPECT_EQ(test::bytes_of(path("a.ply")), test::bytes_of(path("alone.ply")));
    EXPECT_TRUE(io::open_scan(path("a.las")));
    // Another reader's view of the file: 151.25 m2 of walls and 38.4 m2 of blocks.
    ASSERT_EQ(lucarne("info " + path("a.ply") + " --json " + path("info.json")).code, 0);
    std::ifstream file(path("info.json"));
    const auto info = nlohmann::json::parse(file).dump();
    EXPECT_THAT(info, HasSubstr("\"triangles\":34"));
    EXPECT_THAT(info, HasSubstr("\"area_m2\":189.6"));
    for (const char* attribute : {"\"normal\"", "\"color\""}) EXPECT_THAT(info, HasSubstr(attribute));
}

TEST_F(GenerateCommand, AMeshNeedsASceneWithASurfaceAndANameOfItsOwn) {
    const auto survey = lucarne("generate survey --mesh " + path("a.ply"));
    EXPECT_EQ(survey.code, 2);
    EXPECT_THAT(survey.output, HasSubstr("has no true surface"));
    EXPECT_EQ(lucarne("generate cornell -o " + path("a.ply") + " --mesh " + path("a.ply")).code, 2);
    EXPECT_EQ(lucarne("generate cornell --mesh " + path("a.ply") + " --mesh-step 0").code, 2);
    EXPECT_TRUE(std::filesystem::is_empty(folder_.path()));
    std::ofstream(path("a.ply")) << "precious";
    EXPECT_EQ(lucarne("generate cornell --mesh " + path("a.ply")).code, 1);
    EXPECT_EQ(test::bytes_of(path("a.ply")), "precious");
}

TEST_F(GenerateCommand, AFileThatExistsIsKeptUnlessOverwritten) {
    std::ofstream(path("a.las")) << "precious";
    const auto refused = lucarne("generate furnace --points 1000 -o " + path("a.las"));
    EXPECT_EQ(refused.code, 1);
    EXPECT_THAT(refused.output, HasSubstr("--overwrite"));
    EXPECT_EQ(test::bytes_of(path("a.las")), "precious");
    EXPECT_EQ(lucarne("generate furnace --points 1000 --overwrite -o " + path("a.las")).code, 0);
    EXPECT_TRUE(io::open_scan(path("a.las")));
}

}  // namespace
}  // namespace lucarne
