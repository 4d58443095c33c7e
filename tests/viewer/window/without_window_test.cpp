// Menus and panels that are drawn without a window.
#include <algorithm>
#include <string>
#include <vector>

#define GLFW_INCLUDE_NONE
#include <GLFW/glfw3.h>
#include <gmock/gmock.h>

#include "tests/viewer/window/imgui_context.h"
#include "viewer/measure/section_panel.h"
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

class MeasurePanels : public testing::Test {
 protected:
    test::ImguiContext imgui_{{1280, 800}};
    ViewModel model_{10};
};

TEST_F(MeasurePanels, TheSectionIsClosedByItsButton) {
    MeasureModel& measure = model_.measure;
    measure.list.add({MeasureKind::section, "", {ExactPoint{}, ExactPoint{}}, 1});
    measure.selected = 0;
    model_.view.side_bar.unfold(BarSection::measure);
    SectionPanel panel;
    ImVec2 button;
    const auto draw = [&] {
        panel.draw(model_.measuring());
        if (ImGui::Begin("Section")) {  // the same window once more, to ask where it is
            const float inside = ImGui::GetFontSize() / 2 + ImGui::GetStyle().FramePadding.y;
            button = {ImGui::GetWindowPos().x + ImGui::GetWindowWidth() - inside,
                      ImGui::GetWindowPos().y + inside};
        }
        ImGui::End();
    };
    imgui_.frame({0, 0}, false, draw);
    EXPECT_TRUE(measure.selected);
    imgui_.click(button, [&] { panel.draw(model_.measuring()); });
    EXPECT_FALSE(measure.selected);
    EXPECT_EQ(measure.list.all().size(), 1u) << "it stays in the list";
}

TEST_F(MeasurePanels, AllToolsFitIntoTheNarrowestBar) {
    float width = 0, right = 0;
    for (int i = 0; i < 2; ++i)
        imgui_.frame({0, 0}, false, [&] {
            width = static_cast<float>(SideBar::kLeast) * ImGui::GetFontSize();
            ImGui::SetNextWindowPos({0, 0});
            ImGui::SetNextWindowSize({width, 700});
            ImGui::Begin("bar");
            draw_measure_panel(model_.measuring());
            for (const ImDrawVert& vertex : ImGui::GetWindowDrawList()->VtxBuffer)
                right = std::max(right, vertex.pos.x);
            ImGui::End();
        });
    EXPECT_LE(right, width + 4) << "but for the soft edge of the border";
}

}  // namespace
}  // namespace lucarne::viewer
