// Compares the window with the pictures in tests/viewer/window/golden, whose README says how to renew them.
#include <fstream>

#include <fmt/format.h>

#include "tests/viewer/window/golden.h"
#include "tests/viewer/window/window_fixture.h"

namespace lucarne {
namespace {

using namespace test;

std::string golden(const std::string& name) {
    return LUCARNE_SOURCE_DIR "/tests/viewer/window/golden/" + name + ".png";
}

class GoldenWindow : public ViewerWindow {
 protected:
    /// Opens sections of the side bar by their names in the settings.
    void open_sections(const std::string& list) const {
        std::filesystem::create_directory(folder_ / "config");
        std::ofstream(folder_ / "config/settings.json") << R"({"side_bar": {"open": [)" << list << "]}}";
    }
    /// Makes a cache of a virtual scan, with the stations of its scanner.
    std::string scan_of(const std::string& scene) const {
        const std::string scan = folder_ / (scene + ".las"), cache = folder_ / (scene + ".luc");
        const Outcome made = lucarne("generate " + scene + " --points 120k -o " + scan);
        EXPECT_EQ(made.code, 0) << made.output;
        const Outcome converted = lucarne("convert " + scan + " -o " + cache);
        EXPECT_EQ(converted.code, 0) << converted.output;
        return cache;
    }
    void expect_as_kept(const std::string& name, const std::string& arguments) const {
        xdo("mousemove 990 740");  // spots and handles under the mouse look different
        const std::string shot = folder_ / (name + ".png");
        const Outcome ran = shell("env -C " + folder_.path().string() + " " + display_ +
                                  "LUCARNE_CONFIG=" + (folder_ / "config") +
                                  " ASAN_OPTIONS=detect_leaks=0 " LUCARNE_BINARY " view " + arguments +
                                  " --size 800x560 --frames 8 --screenshot " + shot);
        ASSERT_EQ(ran.code, 0) << ran.output;
        if (std::getenv("LUCARNE_RENEW_GOLDEN")) {
            std::filesystem::copy_file(shot, golden(name), std::filesystem::copy_options::overwrite_existing);
            GTEST_SKIP() << "renewed: look at " << golden(name);
        }
        const auto now = io::read_png(shot), kept = io::read_png(golden(name));
        ASSERT_TRUE(now && kept) << golden(name);
        const GoldenDifference found = golden_difference(*now, *kept);
        if (found.tolerated()) return;
        const auto there = std::filesystem::temp_directory_path() / ("lucarne-golden-" + name + ".png");
        std::filesystem::copy_file(shot, there, std::filesystem::copy_options::overwrite_existing);
        ADD_FAILURE() << fmt::format(
            "{} differs from {}: {:.2f} in the mean, {:.1f} about pixel {}, {}; if that is meant, see the "
            "README there",
            there.string(), golden(name), found.mean, found.worst, found.x, found.y);
    }
};

TEST_F(GoldenWindow, ExplainsItselfWithNothingOpen) {
    expect_as_kept("start", "");
}

TEST_F(GoldenWindow, ShowsALitScanBesideItsSideBar) {
    open_sections(R"("scans", "light")");
    expect_as_kept("lit", "cornell.luc --scene " LUCARNE_SOURCE_DIR "/data/scenes/cornell.json --engine vpl");
}

TEST_F(GoldenWindow, ShowsMeasurementsOverTheScanAndInTheirSection) {
    open_sections(R"("measure")");
    std::ofstream(folder_ / "measured.json") << R"({"measurements": [
        {"kind": "distance", "name": "back wall", "points": [{"position": [0.6, 5.5, 3.2]}, {"position": [4.9, 5.5, 3.2]}]},
        {"kind": "area", "name": "floor", "points": [{"position": [0.4, 0.4, 0]}, {"position": [5, 0.4, 0]},
                                                       {"position": [5, 1.6, 0]}, {"position": [0.4, 1.6, 0]}]}]})";
    expect_as_kept("measured", "cornell.luc --scene " LUCARNE_SOURCE_DIR
                               "/data/scenes/cornell.json --engine direct --measurements measured.json");
}

TEST_F(GoldenWindow, ShowsAClippedScanInColoursOfItsHeightWithLegendAxesAndHandles) {
    open_sections(R"("look")");
    expect_as_kept("clipped",
                   "cornell.luc --scene " LUCARNE_SOURCE_DIR
                   "/data/scenes/cornell.json --engine unlit --shading eye-dome --colour elevation --legend "
                   "--axes --scale-bar --clip-box=-1,1.5,-1,7,7,3.5");
}

TEST_F(GoldenWindow, ShowsAFlythroughsPathAndItsKeyFrames) {
    open_sections(R"("flythrough")");
    std::ofstream(folder_ / "flythrough.json") << R"({"keys": [
        {"time": 0, "position": [1, 1, 1], "target": [2.75, 5, 2.75], "fov": 40},
        {"time": 2, "position": [3, 2, 4], "target": [2.75, 5, 2.75], "fov": 40},
        {"time": 5, "position": [5, 1, 2], "target": [2.75, 5, 2.75], "fov": 40}]})";
    expect_as_kept("flythrough", "cornell.luc --scene " LUCARNE_SOURCE_DIR
                                 "/data/scenes/cornell.json --engine direct --path flythrough.json");
}

TEST_F(GoldenWindow, ShowsARoomFromInsideAndTheSpotsOfItsStations) {
    expect_as_kept("room", scan_of("nave"));
}

TEST_F(GoldenWindow, ShowsAHouseInDaylightAsItIsFirstSeen) {
    expect_as_kept("house", scan_of("house") + " --mood daylight --engine direct");
}

/// A golden picture, changed as defects would change it.
class GoldenTolerance : public testing::Test {
 protected:
    void SetUp() override {
        auto kept = io::read_png(golden("lit"));
        ASSERT_TRUE(kept) << kept.error().line();
        kept_ = changed_ = std::move(*kept);
    }
    uint8_t* pixel(uint32_t x, uint32_t y) { return &changed_.bytes[3 * (size_t{y} * changed_.width + x)]; }
    /// Passes every byte of a rectangle through `change`.
    template <class Change>
    void alter(uint32_t left, uint32_t top, uint32_t right, uint32_t bottom, const Change& change) {
        for (uint32_t y = top; y < bottom; ++y)
            for (uint32_t x = left; x < right; ++x)
                for (size_t c = 0; c < 3; ++c)
                    pixel(x, y)[c] =
                        static_cast<uint8_t>(std::clamp(change(pixel(x, y)[c], x, y, c), 0.0, 255.0));
    }
    bool tolerated() const { return golden_difference(changed_, kept_).tolerated(); }

    io::Image8 kept_, changed_;
};

TEST_F(GoldenTolerance, LetsTheSamePictureAndSmoothedGlyphsThrough) {
    EXPECT_TRUE(tolerated());
    // Mixes each pixel with an eighth of both neighbours, over the menu and a part of the side bar: smoothing
    // does not shift glyphs.
    const auto before = [&](uint32_t x, uint32_t y, size_t c) {
        return kept_.bytes[3 * (size_t{y} * kept_.width + x) + c];
    };
    alter(1, 0, 300, 200, [&](uint8_t value, uint32_t x, uint32_t y, size_t c) {
        return 0.75 * value + 0.125 * before(x - 1, y, c) + 0.125 * before(x + 1, y, c);
    });
    EXPECT_TRUE(tolerated()) << golden_difference(changed_, kept_).mean << ", "
                             << golden_difference(changed_, kept_).worst;
}

TEST_F(GoldenTolerance, RefusesAMissingPanelAMissingLineAndBlotchyLight) {
    alter(8, 40, 150, 60, [](uint8_t, uint32_t, uint32_t, size_t) { return 16.0; });
    EXPECT_FALSE(tolerated()) << "a button is missing";
    changed_ = kept_;
    alter(400, 240, 560, 242, [](uint8_t, uint32_t, uint32_t, size_t) { return 255.0; });
    EXPECT_FALSE(tolerated()) << "a line is too many";
    changed_ = kept_;
    alter(330, 30, 640, 450, [](uint8_t value, uint32_t x, uint32_t y, size_t) {
        return value * (1 + 0.15 * std::sin(x / 12.0) * std::sin(y / 12.0));
    });
    EXPECT_FALSE(tolerated()) << "blotches of 15 %";
    changed_ = kept_;
    alter(330, 30, 640, 450, [](uint8_t value, uint32_t, uint32_t, size_t) { return value * 0.97; });
    EXPECT_FALSE(tolerated()) << "darker by 3 %";
}

}  // namespace
}  // namespace lucarne
