// A viewer in a real window: an X server without a screen (Xvfb), driven as a user would (xdotool).
#pragma once

#include <chrono>
#include <optional>
#include <thread>

#include <gmock/gmock.h>

#include "io/image/image.h"
#include "tests/viewer/program.h"
#include "tests/viewer/window/picture_difference.h"
#include "tests/viewer/window/virtual_screen.h"

namespace lucarne::test {

inline constexpr int kWidth = 480, kHeight = 360;  ///< of the window, unless a test has another

class ViewerWindow : public testing::Test {
 protected:
    void SetUp() override {
        if (!VirtualScreen::installed()) GTEST_SKIP() << "needs Xvfb and xdotool";
        screen_.emplace(1000, 750, folder_.path());
        ASSERT_TRUE(screen_->started()) << "Xvfb does not start";
        display_ = screen_->display();
        cache_ = make_cornell(folder_);
    }

    void start(const std::string& more = "") { start_with(cache_ + more); }
    std::string engine_ = " --engine direct";
    /// Starts `lucarne view` with `arguments` and environment `variables`.
    void start_with(const std::string& arguments, const std::string& variables = "") {
        viewer_.emplace(screen_->environment() + variables + " " LUCARNE_BINARY " view " + arguments +
                        engine_ + " --size " + std::to_string(width_) + "x" + std::to_string(height_) +
                        " 2>>" + (folder_ / "log"));
        ASSERT_TRUE(
            eventually([&] { return !viewer_->running() || xdo("search --name 'Lucarne - '").code == 0; }));
        ASSERT_TRUE(viewer_->running()) << "it ended at once";
    }
    std::string log() const { return bytes_of(folder_ / "log"); }
    Outcome xdo(const std::string& command) const { return screen_->xdo(command); }
    void drag(int button, int from_x, int from_y, int to_x, int to_y) const {
        const auto at = [](int x, int y) { return std::to_string(x) + " " + std::to_string(y); };
        std::string moves = "mousemove " + at(from_x, from_y) + " sleep 0.3 mousedown " +
                            std::to_string(button) + " sleep 0.3";
        for (int step = 1; step <= 5; ++step)
            moves += " mousemove " +
                     at(from_x + (to_x - from_x) * step / 5, from_y + (to_y - from_y) * step / 5) +
                     " sleep 0.1";
        EXPECT_EQ(xdo(moves + " mouseup " + std::to_string(button)).code, 0);
    }

    /// Returns the picture at rest: saves it with the viewer's key until it is complete and `wanted` accepts
    /// it.
    template <class Wanted>
    std::optional<io::Image8> picture(const Wanted& wanted) {
        std::optional<io::Image8> result;
        eventually([&] {
            if (!viewer_->running()) return true;
            const std::string file = folder_ / "lucarne-0001.png";
            std::error_code ignored;
            std::filesystem::remove(file, ignored);
            // The log reports a written picture; reports of earlier ones do not count.
            const size_t before = times_saved();
            xdo("key F12");
            for (int i = 0; i < 40 && times_saved() == before; ++i)
                std::this_thread::sleep_for(std::chrono::milliseconds(50));
            if (times_saved() == before || !whole()) return false;
            const auto saved = io::read_png(file);
            if (!saved || saved->width != width_ * scale_ * resolution_ ||
                saved->height != height_ * scale_ * resolution_ || !wanted(*saved))
                return false;
            result = *saved;
            return true;
        });
        return result;
    }
    size_t times_saved() const {
        const std::string said = log();
        constexpr std::string_view kName = "lucarne-0001.png";
        size_t times = 0;
        for (size_t at = said.find(kName); at != said.npos; at = said.find(kName, at + 1)) ++times;
        return times;
    }
    /// Whether the last saved picture had all its points, and nothing moved.
    bool whole() const {
        const std::string said = log();
        const size_t at = said.rfind("lucarne-0001.png");
        return at != std::string::npos && said.find("preview quality", at) == std::string::npos;
    }
    /// Whether `image` is nearer to `to` than to `than`. Pictures of the same view differ only at edges,
    /// however far both are averaged.
    static bool nearer(const io::Image8& image, const io::Image8& to, const io::Image8& than) {
        return difference(image, to) < difference(image, than) / 4;
    }
    static bool lit(const io::Image8& image) { return deviation(image) > 10; }

    TemporaryFolder folder_;
    std::optional<VirtualScreen> screen_;
    std::optional<Background> viewer_;
    std::string display_, cache_;
    int width_ = kWidth, height_ = kHeight;
    uint32_t scale_ = 1;     ///< screen pixels along a side of a desktop's unit
    double resolution_ = 1;  ///< share of the window's width and height at which pictures are made (--scale)
};

/// A window under a small window manager (openbox), which adds frames, sets the focus and requests closing.
class ManagedWindow : public ViewerWindow {
 protected:
    void SetUp() override {
        if (!installed("openbox")) GTEST_SKIP() << "needs openbox";
        ViewerWindow::SetUp();
        if (IsSkipped() || HasFatalFailure()) return;
        manager_.emplace("env " + display_ + "openbox --sm-disable 2>/dev/null");
        ASSERT_TRUE(eventually([&] { return xdo("get_num_desktops").code == 0; })) << "no window manager";
    }
    /// Returns the title of the focused window, or an empty text.
    std::string title() const {
        const Outcome name = xdo("getactivewindow getwindowname");
        return name.code == 0 ? name.output : "";
    }
    bool title_comes(const std::string& part) const {
        return eventually([&] { return title().find(part) != std::string::npos; });
    }

    std::optional<Background> manager_;
};

}  // namespace lucarne::test
