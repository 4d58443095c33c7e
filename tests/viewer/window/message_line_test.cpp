// The line at the bottom of the window, without a window.
#include <algorithm>
#include <memory>
#include <string>

#include <gtest/gtest.h>

#include "tests/viewer/window/imgui_context.h"
#include "viewer/window/drawn_frame.h"
#include "viewer/window/panels/panels.h"

namespace lucarne::viewer {
namespace {

const ImVec2 kWindow(1000, 600);

class MessageLine : public testing::Test {
 protected:
    void draw() {
        context_.frame({0, 0}, false, [&] { draw_message(model_, busy_); });
    }
    /// Returns the rectangle of all that the last frame drew: from its top left to its bottom right.
    static ImVec4 drawn() {
        ImVec4 all(1e9f, 1e9f, -1e9f, -1e9f);
        const ImDrawData& data = *ImGui::GetDrawData();
        for (int i = 0; i < data.CmdListsCount; ++i)
            for (const ImDrawVert& vertex : data.CmdLists[i]->VtxBuffer)
                all = {std::min(all.x, vertex.pos.x), std::min(all.y, vertex.pos.y),
                       std::max(all.z, vertex.pos.x), std::max(all.w, vertex.pos.y)};
        return all;
    }
    float bar() const {
        return static_cast<float>(model_.view.side_bar.pixels(ImGui::GetFontSize(), kWindow.x));
    }

    test::ImguiContext context_{kWindow};
    ViewModel model_{1.0};
    bool busy_ = false;
};

TEST_F(MessageLine, WrapsALongTextBesideTheSideBar) {
    for (const std::string& text : {std::string(400, 'W'), [] {
                                        std::string words;
                                        for (int i = 0; i < 80; ++i) words += "word ";
                                        return words;
                                    }()}) {
        model_.view.message = text;
        draw();
        const ImVec4 plate = drawn();
        EXPECT_GE(plate.x, bar());
        EXPECT_LE(plate.z, kWindow.x);
        EXPECT_GT(plate.w - plate.y, 2 * ImGui::GetTextLineHeight()) << "more than one line";
        EXPECT_LT(plate.w, kWindow.y - 2 * ImGui::GetTextLineHeight()) << "above the row of coordinates";
    }
    model_.health.picture = std::string(400, 'W');
    draw();
    EXPECT_GE(drawn().x, bar());
    EXPECT_LE(drawn().z, kWindow.x) << "problems are wrapped as well";
}

TEST_F(MessageLine, ShowsAShortTextInTheRowOfTheCoordinatesWhereBothHaveRoom) {
    model_.view.side_bar.shown = false;
    model_.view.message = "saved";
    draw();
    EXPECT_GT(drawn().w, kWindow.y - ImGui::GetTextLineHeight());
}

TEST_F(MessageLine, ShowsANewTextWhollyInItsFirstFrame) {
    model_.view.message = "Distance";
    draw();
    draw();
    model_.view.message = "Distance: click two points";
    draw();
    const uint64_t first = fingerprint(*ImGui::GetDrawData());
    for (int i = 0; i < 3; ++i) draw();
    EXPECT_EQ(first, fingerprint(*ImGui::GetDrawData()));
}

TEST_F(MessageLine, LeavesTheCornerToTheSignOfConvergence) {
    context_.frame({0, 0}, false, [&] {
        auto picture = std::make_shared<Picture>();
        picture->stats.accumulated = 255;
        model_.view.picture = picture;
        draw_convergence(model_.view);
    });
    EXPECT_NEAR(drawn().x, convergence_left(), 2) << "what is left of it ends there";
    EXPECT_LE(drawn().z, kWindow.x);
    model_.view.message = std::string(120, 'm');
    draw();
    EXPECT_LT(drawn().w, kWindow.y - 2 * ImGui::GetTextLineHeight());
}

}  // namespace
}  // namespace lucarne::viewer
