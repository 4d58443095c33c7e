// Menus and panels that are drawn without a window.
#include <string>
#include <vector>

#define GLFW_INCLUDE_NONE
#include <GLFW/glfw3.h>
#include <gmock/gmock.h>

#include "tests/viewer/window/imgui_context.h"
#include "viewer/ui/popups.h"
#include "viewer/window/actions/actions.h"
#include "viewer/window/panels/panels.h"

namespace lucarne::viewer {
namespace {

using testing::ElementsAre;

class Menus : public testing::Test {
 protected:
    Menus() : actions_(bound_actions(model_)) {
        imgui_.frame({300, 300}, false, [] {});
    }
    void draw() { draw_menu_bar(model_, actions_); }
    /// Returns the title's middle. The menu bar's window has padding, and titles follow each other.
    static ImVec2 title(const std::vector<const char*>& before, const char* name) {
        const ImGuiStyle& style = ImGui::GetStyle();
        float x = style.WindowPadding.x;
        for (const char* other : before) x += ImGui::CalcTextSize(other).x + 2 * style.ItemSpacing.x;
        return {x + ImGui::CalcTextSize(name).x / 2, ImGui::GetFontSize() / 2 + style.FramePadding.y};
    }
    void click(const ImVec2& at) {
        imgui_.click(at, [&] { draw(); });
    }
    void rest(const ImVec2& at) {
        for (int i = 0; i < 3; ++i) imgui_.frame(at, false, [&] { draw(); });
    }
    /// Returns the titles of the open menus.
    std::vector<std::string> open() {
        std::vector<std::string> titles;
        imgui_.frame(ImGui::GetIO().MousePos, false, [&] {
            draw();
            ImGui::BeginMainMenuBar();
            for (const char* name : {"File", "View"})
                if (ImGui::IsPopupOpen(name)) titles.emplace_back(name);
            ImGui::EndMainMenuBar();
        });
        return titles;
    }

    test::ImguiContext imgui_{{1280, 800}};
    ViewModel model_{10};
    std::vector<BoundAction> actions_;
};

TEST_F(Menus, AClickOnAnotherTitleOpensThatOneAndASecondClickClosesIt) {
    const ImVec2 file = title({}, "File"), view = title({"File", "Edit"}, "View");
    click(file);
    EXPECT_THAT(open(), ElementsAre("File"));
    click(view);
    EXPECT_THAT(open(), ElementsAre("View")) << "the mouse opened it before the click";
    click(view);
    EXPECT_THAT(open(), ElementsAre());
    click(view);
    rest(file);
    EXPECT_THAT(open(), ElementsAre("File")) << "the mouse passes over titles";
}

TEST_F(Menus, EscapeClosesWhatIsOpenAndNothingElse) {
    EXPECT_FALSE(close_popups()) << "nothing is open";
    click(title({}, "File"));
    EXPECT_TRUE(close_popups());
    EXPECT_THAT(open(), ElementsAre());
    // A question that has to be answered stays.
    const auto question = [&] {
        ImGui::OpenPopup("question");
        if (ImGui::BeginPopupModal("question")) ImGui::EndPopup();
    };
    for (int i = 0; i < 2; ++i) imgui_.frame({300, 300}, false, question);
    EXPECT_FALSE(close_popups());
}

}  // namespace
}  // namespace lucarne::viewer
