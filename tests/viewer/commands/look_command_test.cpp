// Tests how `lucarne render` shows a scan's attributes.
#include <array>
#include <cmath>

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "gi/scene/colour_map.h"
#include "io/image/image.h"
#include "tests/viewer/program.h"

namespace lucarne::viewer {
namespace {

using test::Outcome;

/// Two squares of 21 x 21 points beside each other, facing up; the left one is ground at z = 1, the right one
/// a roof at z = 2 under a lid of noise at z = 3.
class LookCommand : public testing::Test {
 protected:
    static void SetUpTestSuite() {
        folder_ = new test::TemporaryFolder;
        std::ofstream scan(*folder_ / "scan.xyz");
        const auto square = [&](double left, double z, int intensity, int cls) {
            for (int y = 0; y <= 20; ++y)
                for (int x = 0; x <= 20; ++x)
                    scan << left + x * 0.05 << ' ' << y * 0.05 << ' ' << z << ' ' << intensity << ' ' << cls
                         << " 0 0 1\n";
        };
        square(0, 1, 100, 2);
        square(1.05, 2, 300, 6);
        square(1.05, 3, 900, 7);
        scan.close();
        std::ofstream scene(*folder_ / "scene.json");
        scene << R"({"cameras": [{"name": "above", "position": [1.025, 0.5, 40], "target": [1.025, 0.5, 0],
                                  "up": [0, 1, 0], "fov": 3}]})";
        scene.close();
        const Outcome converted =
            test::lucarne("convert " + at("scan.xyz") +
                          " --columns x,y,z,intensity,classification,nx,ny,nz -o " + at("scan.luc"));
        ASSERT_EQ(converted.code, 0) << converted.output;
    }
    static void TearDownTestSuite() { delete folder_; }
    static std::string at(const std::string& name) { return *folder_ / name; }

    /// Returns the picture's colours over the left and the right square, sRGB.
    static std::array<glm::vec3, 2> halves(const std::string& options) {
        const Outcome ran =
            test::lucarne("render " + at("scan.luc") + " -o " + at("out.png") + " --overwrite --scene " +
                          at("scene.json") + " --engine unlit --shading flat --size 128x128 " + options);
        EXPECT_EQ(ran.code, 0) << ran.output;
        const auto picture = io::read_png(at("out.png"));
        if (!picture) return {};
        const auto pixel = [&](uint32_t x, uint32_t y) {
            const uint8_t* p = &picture->bytes[3 * (size_t{y} * 128 + x)];
            return glm::vec3(p[0], p[1], p[2]) / 255.0f;
        };
        return {pixel(40, 64), pixel(88, 64)};
    }
    static test::TemporaryFolder* folder_;
};
test::TemporaryFolder* LookCommand::folder_ = nullptr;

MATCHER_P(Shows, colour, "") {
    return std::abs(arg.x - colour.x) < 0.006f && std::abs(arg.y - colour.y) < 0.006f &&
           std::abs(arg.z - colour.z) < 0.006f;
}
const glm::vec3 kBlack(0.0f);
glm::vec3 viridis(double place) {
    return gi::mapped_colour(gi::ColourMap::viridis, place);
}

TEST_F(LookCommand, PixelsHaveExactlyTheColoursOfTheirPointsValues) {
    auto both = halves("--colour classification");
    EXPECT_THAT(both[0], Shows(gi::class_colour(2)));
    EXPECT_THAT(both[1], Shows(gi::class_colour(7)));
    both = halves("--colour intensity --range 0:1000");
    EXPECT_THAT(both[0], Shows(viridis(0.1)));
    EXPECT_THAT(both[1], Shows(viridis(0.9)));
    both = halves("--color elevation --range 1:5 --color-map cividis --reverse-map");
    EXPECT_THAT(both[0], Shows(gi::mapped_colour(gi::ColourMap::cividis, 1)));
    EXPECT_THAT(both[1], Shows(gi::mapped_colour(gi::ColourMap::cividis, 0.5)));
    both = halves("--colour attribute:intensity");
    EXPECT_THAT(both[0], Shows(viridis(0))) << "measured range";
    EXPECT_THAT(both[1], Shows(viridis(1)));
    both = halves("--colour normal");
    EXPECT_THAT(both[0], Shows(glm::vec3(0.5f, 0.5f, 1)));
}

TEST_F(LookCommand, HiddenClassesAndClipsShowWhatIsBehindThem) {
    auto both = halves("--colour classification --hide-class 7,18");
    EXPECT_THAT(both[1], Shows(gi::class_colour(6)));
    both = halves("--colour classification --clip-plane 0,0,2.5,0,0,-1");
    EXPECT_THAT(both[0], Shows(gi::class_colour(2)));
    EXPECT_THAT(both[1], Shows(gi::class_colour(6)));
    both = halves("--colour classification --clip-box -1,-1,1.5,9,9,9");
    EXPECT_THAT(both[0], Shows(kBlack));
    EXPECT_THAT(both[1], Shows(gi::class_colour(7)));
    both = halves("--colour classification --clip-outside -1,-1,1.5,9,9,9");
    EXPECT_THAT(both[0], Shows(gi::class_colour(2)));
    EXPECT_THAT(both[1], Shows(kBlack));
    // The box is a wall between the squares; turned, it runs through both.
    both = halves("--colour classification --clip-box 0.875,-5,-1,1.175,6,9");
    EXPECT_THAT(both[0], Shows(kBlack));
    EXPECT_THAT(both[1], Shows(kBlack));
    both = halves("--colour classification --clip-box 0.875,-5,-1,1.175,6,9,90");
    EXPECT_THAT(both[0], Shows(gi::class_colour(2)));
    EXPECT_THAT(both[1], Shows(gi::class_colour(7)));
}

TEST_F(LookCommand, TheBackgroundShowsWhereNoPointIs) {
    const auto both = halves("--background 0.2,0.4,0.6 --clip-plane 0,0,1.5,0,0,-1");
    EXPECT_THAT(both[1], Shows(glm::vec3(0.2f, 0.4f, 0.6f)));
}

TEST_F(LookCommand, TheSamePixelsForEveryNumberOfThreadsAndRuns) {
    for (const char* shading : {"eye-dome", "occlusion", "relief"}) {
        const std::string command = "render " + at("scan.luc") +
                                    " --overwrite --engine unlit --colour intensity --shading " +
                                    std::string(shading) + " --size 128x96 --axes --legend --scale-bar -o ";
        ASSERT_EQ(test::lucarne(command + at("a.png")).code, 0);
        ASSERT_EQ(test::shell("LP_NUM_THREADS=1 " LUCARNE_BINARY " " + command + at("b.png")).code, 0);
        EXPECT_EQ(test::bytes_of(at("a.png")), test::bytes_of(at("b.png"))) << shading;
    }
}

TEST_F(LookCommand, MistakesAreBadArgumentsThatNameTheOption) {
    const std::pair<const char*, const char*> mistakes[] = {
        {"--colour hue", "--colour"},
        {"--colour attribute:absent", "absent"},
        {"--colour attribute", "--colour"},
        {"--range 5", "--range"},
        {"--range 1:x", "--range"},
        {"--colour-map jet", "viridis"},
        {"--clip-box 0,0,0,1,1", "--clip-box"},
        {"--clip-box 1,0,0,0,1,1", "--clip-box"},
        {"--clip-box 0,0,0,1,1,1,x", "--clip-box"},
        {"--clip-plane 0,0,0,0,0,0", "--clip-plane"},
        {"--background 2,0,0", "--background"},
        {"--shading phong", "--shading"},
    };
    for (const auto& [options, named] : mistakes) {
        const Outcome ran = test::lucarne("render " + at("scan.luc") + " -o " + at("never.png") +
                                          " --engine unlit " + options);
        EXPECT_EQ(ran.code, 2) << options << ran.output;
        EXPECT_THAT(ran.output, testing::HasSubstr(named)) << options;
    }
}

}  // namespace
}  // namespace lucarne::viewer
