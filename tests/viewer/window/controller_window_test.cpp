// A 6-DoF controller, replayed by umockdev, in a real window.
#include <algorithm>
#include <filesystem>
#include <optional>

#include <gtest/gtest.h>

#include "tests/io/input/replayed_controller.h"
#include "tests/viewer/window/window_fixture.h"

namespace lucarne {
namespace {

using namespace test;

class ControllerWindow : public ViewerWindow {
 protected:
    /// Starts the viewer with a controller that gives these answers, then none.
    void start_with_controller(const std::vector<io::test::Answer>& answers) {
        std::string device;
        for (const std::string& word : io::test::under_umockdev(folder_.path(), answers))
            device += word + " ";
        start_with(cache_, device);
    }
    /// Saves what the window shows, at rest or not.
    std::optional<io::Image8> saved() {
        const std::string file = folder_ / "lucarne-0001.png";
        std::error_code ignored;
        std::filesystem::remove(file, ignored);
        const size_t before = times_saved();
        xdo("key F12");
        if (!viewer_->running() || times_saved() == before) return std::nullopt;
        const auto image = io::read_png(file);
        return image ? std::optional(*image) : std::nullopt;
    }
    /// Pictures of a motion may be smaller than the window: repeats their pixels.
    static io::Image8 as_large(const io::Image8& small, const io::Image8& as) {
        io::Image8 large = as;
        for (uint32_t y = 0; y < as.height; ++y)
            for (uint32_t x = 0; x < as.width; ++x) {
                const size_t from =
                    size_t{y * small.height / as.height} * small.width + x * small.width / as.width;
                std::copy_n(&small.bytes[3 * from], 3, &large.bytes[3 * (size_t{y} * as.width + x)]);
            }
        return large;
    }
};

TEST_F(ControllerWindow, AHeldCapMovesTheCamera) {
    if (!installed("umockdev-run")) GTEST_SKIP() << "needs umockdev";
    start();
    const auto before = picture(lit);
    ASSERT_TRUE(before);
    xdo("key ctrl+q");
    ASSERT_TRUE(eventually([&] { return !viewer_->running(); }));

    // A cap that is held sends nothing more, so the push lasts until there is a view, and the view need not
    // come to rest.
    start_with_controller({{io::test::axes_report(1, 120, 0, 0)}});
    EXPECT_TRUE(eventually([&] {
        const auto seen = saved();
        return seen && difference(as_large(*seen, *before), *before) > 20;
    })) << "pushed to the right\n"
        << log();
}

TEST_F(ControllerWindow, GoesOnWhenTheControllerIsUnpluggedInTheMiddle) {
    if (!installed("umockdev-run")) GTEST_SKIP() << "needs umockdev";
    start_with_controller({{io::test::axes_report(1, 0, 0, 0)}, {{}, -19}});
    EXPECT_TRUE(picture(lit)) << log();
    EXPECT_TRUE(viewer_->running());
}

}  // namespace
}  // namespace lucarne
