// A window on a screen with 192 dots an inch, as set in the desktop's resources (x11/set_dpi.cpp).
#include <algorithm>
#include <cmath>

#include "gi/scene/scene.h"
#include "tests/viewer/window/measuring_window.h"

#ifndef LUCARNE_SET_DPI
#define LUCARNE_SET_DPI ""  // X11's headers are missing
#endif

namespace lucarne {
namespace {

using namespace test;
using testing::HasSubstr;

class FineScreen : public MeasuringWindow {
 protected:
    void SetUp() override {
        if (std::string(LUCARNE_SET_DPI).empty()) GTEST_SKIP() << "needs libx11-dev";
        MeasuringWindow::SetUp();
    }
    void set_scale(uint32_t scale) {
        scale_ = scale;
        EXPECT_EQ(shell(display_ + LUCARNE_SET_DPI " " + std::to_string(96 * scale)).code, 0);
    }
    /// Returns the whole window with its panels, saved by the window itself.
    io::Image8 window() {
        const std::string file = folder_ / ("window" + std::to_string(scale_) + ".png");
        start_with(cache_ + " --screenshot " + file + " --frames 1 --overwrite");
        EXPECT_TRUE(eventually([&] { return !viewer_->running(); }));
        const auto saved = io::read_png(file);
        EXPECT_TRUE(saved && saved->width == kWidth * scale_ && saved->height == kHeight * scale_);
        return saved ? *saved : io::Image8{};
    }
};

/// The rows of the menu bar's letters, and the number of their pixels that are neither letter nor bar.
struct MenuText {
    uint32_t rows = 0;
    double grey = 0;
};
MenuText menu_text(const io::Image8& window, uint32_t scale) {
    MenuText text;
    const uint32_t bar = 18 * scale, width = 200 * scale;
    size_t letters = 0, grey = 0;
    for (uint32_t y = 0; y < bar; ++y) {
        const size_t before = letters;
        for (uint32_t x = 0; x < width; ++x) {
            const uint8_t green = window.bytes[(size_t{y} * window.width + x) * 3 + 1];
            letters += green > 230;
            grey += green > 60 && green <= 230;
        }
        text.rows += letters > before;
    }
    text.grey = static_cast<double>(grey) / static_cast<double>(std::max<size_t>(letters, 1));
    return text;
}

TEST_F(FineScreen, HasLettersOfTwiceTheHeightThatAreDrawnAnew) {
    const io::Image8 usual = window();
    ASSERT_FALSE(usual.bytes.empty());
    set_scale(2);
    const io::Image8 fine = window();
    ASSERT_FALSE(fine.bytes.empty());
    const MenuText small = menu_text(usual, 1), large = menu_text(fine, 2);
    EXPECT_GT(small.rows, 7u);
    EXPECT_NEAR(large.rows, 2 * small.rows, 1) << "outlines are rounded to pixels";
    EXPECT_LE(large.grey, small.grey + 0.05) << "stretched";
}

TEST_F(FineScreen, IsPickedWhereItIsClicked) {
    set_scale(2);
    measure_a_known_distance();
}

TEST_F(FineScreen, TurnsAsFarByADragAndFindsItsSizeAgain) {
    set_scale(2);
    const std::string scene = folder_ / "scene.json";
    std::filesystem::copy(LUCARNE_SOURCE_DIR "/data/scenes/cornell.json", scene);
    const auto facing = [&] {
        const auto saved = gi::load_scene(scene);
        if (!saved) return 0.0;  // no picture yet
        const glm::dvec3 forward = saved->cameras.at(0).target - saved->cameras.at(0).position;
        return std::atan2(forward.y, forward.x) * 180 / M_PI;
    };
    const double before = facing();
    start(" --scene " + scene);
    ASSERT_TRUE(picture(lit));
    xdo("key Tab key t");  // Tab: the panels would take the drag; T: a turntable turns about the scene's
                           // pivot
    // A drag over the window's height turns by half a circle. On a busy machine the start of a drag may be
    // lost.
    EXPECT_TRUE(eventually([&] {
        xdo("key Home");
        const int from = kWidth, right = kHeight / 2;  // a quarter of the height
        drag(1, from, kHeight, from + right, kHeight);
        std::filesystem::remove(scene);
        xdo("key ctrl+s");
        for (int i = 0; i < 50 && !std::filesystem::exists(scene); ++i)
            std::this_thread::sleep_for(std::chrono::milliseconds(100));
        return std::abs(std::remainder(before - facing() - 45, 360)) < 1;
    })) << before
        << " to " << facing();
    xdo("key ctrl+q");
    ASSERT_TRUE(eventually([&] { return !viewer_->running(); }));
    const std::string settings = bytes_of(folder_ / "config/settings.json");
    EXPECT_THAT(settings, HasSubstr("\"width\": " + std::to_string(kWidth)));
    EXPECT_THAT(settings, HasSubstr("\"height\": " + std::to_string(kHeight)));
}

}  // namespace
}  // namespace lucarne
