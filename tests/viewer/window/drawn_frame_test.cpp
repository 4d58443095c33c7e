#include "viewer/window/drawn_frame.h"

#include <gtest/gtest.h>

#include "tests/viewer/window/imgui_context.h"

namespace lucarne::viewer {
namespace {

/// Makes frames of ImGui without a window.
class DrawnFrame : public testing::Test {
 protected:
    DrawnFrame() {
        for (int i = 0; i < 3; ++i)
            of("a", {100, 100});  // the layout of new windows takes more than one frame
    }

    uint64_t of(const char* text, const ImVec2& mouse, bool dot = false) {
        imgui_.frame(mouse, false, [&] {
            ImGui::SetNextWindowPos({0, 0});
            ImGui::SetNextWindowSize({200, 200});
            ImGui::Begin("window");
            ImGui::TextUnformatted(text);
            ImGui::Button("button", {180, 60});
            ImGui::End();
            if (dot) ImGui::GetBackgroundDrawList()->AddCircleFilled({400, 400}, 3, IM_COL32_WHITE);
        });
        return fingerprint(*ImGui::GetDrawData());
    }

 private:
    test::ImguiContext imgui_{{640, 480}};
};

TEST_F(DrawnFrame, HasTheSameNumberWhereItLooksTheSame) {
    const uint64_t first = of("a", {400, 300});
    EXPECT_EQ(of("a", {400, 300}), first);
    EXPECT_EQ(of("a", {500, 100}), first) << "the cursor over nothing";
}

TEST_F(DrawnFrame, HasAnotherNumberWhereAnythingIsAnother) {
    const uint64_t first = of("a", {400, 300});
    EXPECT_NE(of("b", {400, 300}), first) << "a letter";
    EXPECT_NE(of("a", {100, 80}), first) << "a button that is lit under the cursor";
    EXPECT_NE(of("a", {400, 300}, true), first) << "a dot";
    EXPECT_EQ(of("a", {400, 300}), first);
}

}  // namespace
}  // namespace lucarne::viewer
