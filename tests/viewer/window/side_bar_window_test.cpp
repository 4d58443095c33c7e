// The side bar in a real window, see window_fixture.h.
#include <nlohmann/json.hpp>

#include "tests/viewer/window/window_fixture.h"

namespace lucarne {
namespace {

using namespace test;
using testing::ElementsAre;
using testing::IsEmpty;

/// Returns the y of a header in a bar with all sections closed, for ImGui's sizes with a font of 15 pixels.
int header(int number) {
    return 21 + 8 + 25 * number + 10;
}

class SideBarWindow : public ViewerWindow {
 protected:
    /// Closes the window. Returns the saved settings of the bar.
    nlohmann::json close() {
        xdo("key ctrl+q");
        EXPECT_TRUE(eventually([&] { return !viewer_->running(); }));
        EXPECT_EQ(viewer_->code(), 0);
        return nlohmann::json::parse(bytes_of(folder_ / "config/settings.json"))["side_bar"];
    }
};

TEST_F(SideBarWindow, SectionsOpenByKeysAndClicksItsEdgeIsDraggedAndTheNextWindowHasThemSo) {
    start();
    ASSERT_TRUE(picture(lit));
    xdo("key shift+Tab");  // the only section that is open at first
    nlohmann::json kept = close();
    EXPECT_THAT(kept["open"], IsEmpty());
    const double width = kept["width"];
    start();
    ASSERT_TRUE(picture(lit));
    xdo("mousemove 60 " + std::to_string(header(8)) + " click 1");
    drag(1, 287, 300, 268, 300);
    kept = close();
    EXPECT_THAT(kept["open"], ElementsAre("statistics"));
    EXPECT_LT(kept["width"], width);
    start();
    ASSERT_TRUE(picture(lit));
    xdo("key Tab key m");  // the bar is hidden, and shown again for a section
    const nlohmann::json then = close();
    EXPECT_THAT(then["open"], ElementsAre("measure", "statistics"));
    EXPECT_EQ(then["shown"], true);
    EXPECT_EQ(then["width"], kept["width"]);
}

}  // namespace
}  // namespace lucarne
