// Tests `lucarne render` with switched-off lights, false colours, flattened colours and two engines.
#include <algorithm>
#include <array>
#include <cmath>

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "gi/post/false_colour.h"
#include "io/image/image.h"
#include "tests/viewer/program.h"

namespace lucarne::viewer {
namespace {

using test::Outcome;

/// A grey floor of 84 x 42 points that was recorded in brighter light on the right than on the left.
class LightCommand : public testing::Test {
 protected:
    static constexpr int kWidth = 256, kHeight = 128;  ///< leaves room for legends

    static void SetUpTestSuite() {
        folder_ = new test::TemporaryFolder;
        std::ofstream scan(*folder_ / "scan.xyz");
        for (int y = 0; y < 42; ++y)
            for (int x = 0; x < 84; ++x) {
                const int grey = x < 42 ? 60 : 180;
                scan << x * 0.05 << ' ' << y * 0.05 << " 0 " << grey << ' ' << grey << ' ' << grey
                     << " 0 0 1\n";
            }
        scan.close();
        const Outcome converted = test::lucarne("convert " + at("scan.xyz") +
                                                " --columns x,y,z,r,g,b,nx,ny,nz -o " + at("scan.luc"));
        ASSERT_EQ(converted.code, 0) << converted.output;
    }
    static void TearDownTestSuite() { delete folder_; }
    static std::string at(const std::string& name) { return *folder_ / name; }

    /// Renders a scene with the keys `more` in addition to its camera.
    static io::Image8 render(const std::string& more, const std::string& options,
                             const std::string& cache = "scan.luc") {
        std::ofstream(at("scene.json")) << R"({"cameras": [{"name": "above", "position": [2.075, 1.025, 40],
            "target": [2.075, 1.025, 0], "up": [0, 1, 0], "fov": 2.6}])"
                                        << more << "}";
        const Outcome ran =
            test::lucarne("render " + at(cache) + " -o " + at("out.png") + " --overwrite --scene " +
                          at("scene.json") + " --size 256x128 " + options);
        EXPECT_EQ(ran.code, 0) << ran.output;
        return io::read_png(at("out.png")).value_or(io::Image8{});
    }
    /// Returns the colour at a place of a 128 by 64 grid.
    static glm::vec3 pixel(const io::Image8& picture, int x, int y) {
        if (picture.bytes.empty()) return glm::vec3(-1);
        const uint8_t* p =
            &picture.bytes[3 * (static_cast<size_t>(2 * y) * kWidth + static_cast<size_t>(2 * x))];
        return glm::vec3(p[0], p[1], p[2]) / 255.0f;
    }
    static test::TemporaryFolder* folder_;
};
test::TemporaryFolder* LightCommand::folder_ = nullptr;

const std::string kLamp =
    R"(, "exposure": {"ev": 0, "tone_map": "none"}, "lights": [{"type": "directional", "direction": [0, 0, -1], "irradiance": [2, 2, 2]ON}])";

std::string lamp(const std::string& more) {
    std::string text = kLamp;
    return text.replace(text.find("ON"), 2, more);
}

TEST_F(LightCommand, ALightThatIsOffGivesNone) {
    EXPECT_GT(pixel(render(lamp(""), "--engine direct"), 90, 32).x, 0.3f);
    EXPECT_EQ(pixel(render(lamp(R"(, "on": false)"), "--engine direct"), 90, 32).x, 0.0f);
}

TEST_F(LightCommand, ASunThatHasSetGivesNone) {
    const auto sun = [](const std::string& time) {
        return R"(, "exposure": {"ev": 0}, "lights": [{"type": "directional", "irradiance": [2, 2, 2],
                   "sun": {"latitude": 48.2, "longitude": 16.4, "time": ")" +
               time + "\"}}]";
    };
    EXPECT_GT(pixel(render(sun("2026-06-21T12:00:00+01:00"), "--engine direct"), 90, 32).x, 0.1f);
    EXPECT_EQ(pixel(render(sun("2026-06-21T00:00:00+01:00"), "--engine direct"), 90, 32).x, 0.0f);
}

TEST_F(LightCommand, FalseColoursShowAKnownLuminanceByTheColourOfItsPlace) {
    // 1 W/(sr m^2) is 179 cd/m^2, in the middle of a logarithmic range about it.
    const std::string shining = R"(, "materials": [{"emission": [1, 1, 1], "diffuse": [0, 0, 0]}])";
    const auto seen =
        pixel(render(shining, "--engine direct --tone-map false-colour --luminance 17.9:1790"), 90, 10);
    const glm::vec3 middle = gi::mapped_colour(gi::kLuminanceMap, 0.5);
    for (int i = 0; i < 3; ++i) EXPECT_NEAR(seen[i], middle[i], 0.02f);
}

TEST_F(LightCommand, IlluminanceDoesNotDependOnTheColourOfTheSurface) {
    // 2 W/m^2 straight from above are 358 lx; the left half reflects a tenth of what the right one does.
    const auto seen = render(lamp(""), "--engine direct --tone-map illuminance --luminance 35.8:3580");
    const glm::vec3 middle = gi::mapped_colour(gi::kLuminanceMap, 0.5);
    for (const int x : {30, 98})
        for (int i = 0; i < 3; ++i) EXPECT_NEAR(pixel(seen, x, 10)[i], middle[i], 0.02f) << x;
    // What a surface emits is no light that it receives.
    const std::string shining = R"(, "materials": [{"emission": [9, 9, 9]}])";
    const glm::vec3 dark = gi::mapped_colour(gi::kLuminanceMap, 0);
    const auto emitted =
        pixel(render(shining, "--engine direct --tone-map illuminance --luminance 35.8:3580"), 90, 10);
    for (int i = 0; i < 3; ++i) EXPECT_NEAR(emitted[i], dark[i], 0.02f);
}

TEST_F(LightCommand, FlatteningEvensOutTheLightThatColoursWereTakenIn) {
    const auto taken = render("", "--engine unlit --shading flat");
    EXPECT_NEAR(pixel(taken, 30, 32).x, 60 / 255.0f, 0.02f);
    EXPECT_NEAR(pixel(taken, 98, 32).x, 180 / 255.0f, 0.02f);
    const auto flat = render("", "--engine unlit --shading flat --flatten 1");
    EXPECT_NEAR(pixel(flat, 30, 32).x, pixel(flat, 98, 32).x, 0.02f);
    EXPECT_GT(pixel(flat, 30, 32).x, 60 / 255.0f);
    EXPECT_LT(pixel(flat, 98, 32).x, 180 / 255.0f);
}

TEST_F(LightCommand, StationsOfDifferentExposureAreBalancedUnlessTheyAreToStay) {
    // The right half again, from a station that records half of the light: 131 instead of 180.
    std::ofstream scan(at("dim.xyz"));
    for (int y = 0; y < 42; ++y)
        for (int x = 42; x < 84; ++x)
            scan << x * 0.05 + 0.025 << ' ' << y * 0.05 + 0.025 << " 0 131 131 131 0 0 1\n";
    scan.close();
    const Outcome converted = test::lucarne("convert " + at("scan.xyz") + " " + at("dim.xyz") +
                                            " --columns x,y,z,r,g,b,nx,ny,nz -o " + at("two.luc"));
    ASSERT_EQ(converted.code, 0) << converted.output;
    EXPECT_THAT(test::lucarne("info " + at("two.luc")).output, testing::HasSubstr("station_colours"));
    const auto range = [](const io::Image8& picture) {
        float least = 1, most = 0;
        for (int y = 20; y < 44; ++y)
            for (int x = 80; x < 110; ++x) {
                const float grey = pixel(picture, x, y).x;
                least = std::min(least, grey);
                most = std::max(most, grey);
            }
        return std::pair(least, most);
    };
    const auto [dim, bright] =
        range(render("", "--engine unlit --shading flat --unbalanced --single-discs", "two.luc"));
    EXPECT_NEAR(dim, 131 / 255.0f, 0.02f);
    EXPECT_NEAR(bright, 180 / 255.0f, 0.02f);
    const auto [least, most] = range(render("", "--engine unlit --shading flat", "two.luc"));
    EXPECT_NEAR(least, 154 / 255.0f, 0.02f) << "between them: the gains' product is 1";
    EXPECT_NEAR(most, least, 0.01f);
    const std::string off = R"(, "albedo": {"balance": false})";
    EXPECT_NEAR(range(render(off, "--engine unlit --shading flat --single-discs", "two.luc")).first, dim,
                0.001f);
}

TEST_F(LightCommand, AnAlbedoOfHalfReflectsHalf) {
    const auto linear = [](float v) { return std::pow((v + 0.055f) / 1.055f, 2.4f); };
    const auto whole = pixel(render(lamp(""), "--engine direct"), 98, 32).x;
    const auto half = pixel(render(lamp(""), "--engine direct --albedo 0.5"), 98, 32).x;
    EXPECT_NEAR(linear(half), linear(whole) / 2, 0.01f);
}

TEST_F(LightCommand, ASplitPictureIsOneEngineLeftOfTheBorderAndAnotherRightOfIt) {
    const auto direct = render(lamp(""), "--engine direct"), unlit = render(lamp(""), "--engine unlit");
    const auto both = render(lamp(""), "--engine direct --beside unlit --border 0.25");
    ASSERT_EQ(both.bytes.size(), direct.bytes.size());
    for (int y = 0; y < kHeight / 2; ++y)
        for (int x = 0; x < kWidth / 2; ++x)
            ASSERT_EQ(pixel(both, x, y), pixel(x < kWidth / 8 ? direct : unlit, x, y)) << x << ' ' << y;
    EXPECT_NE(direct.bytes, unlit.bytes);
}

TEST_F(LightCommand, AnEngineDiffersFromItselfNowhere) {
    const auto same =
        pixel(render(lamp(""), "--engine direct --beside direct --beside-show absolute"), 98, 10);
    const auto nought = gi::mapped_colour(gi::kDifferenceMap, 0);
    for (int i = 0; i < 3; ++i) EXPECT_NEAR(same[i], nought[i], 0.01f);
    const auto middle = gi::mapped_colour(gi::kSignedMap, 0.5);
    const auto signs =
        pixel(render(lamp(""), "--engine direct --beside direct --beside-show signed"), 98, 10);
    for (int i = 0; i < 3; ++i) EXPECT_NEAR(signs[i], middle[i], 0.01f);
}

TEST_F(LightCommand, MistakesAreRefusedInOneLine) {
    for (const char* mistake : {"--tone-map sepia", "--luminance 5:1", "--luminance 1", "--beside none-such",
                                "--border 0.5", "--beside direct --beside-show both"}) {
        const Outcome ran =
            test::lucarne("render " + at("scan.luc") + " -o " + at("none.png") + " " + mistake);
        EXPECT_EQ(ran.code, 2) << mistake;
        EXPECT_EQ(std::count(ran.output.begin(), ran.output.end(), '\n'), 1) << ran.output;
    }
}

}  // namespace
}  // namespace lucarne::viewer
