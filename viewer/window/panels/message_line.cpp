// The result of the last action, and problems, at the bottom of the window.
#include <algorithm>
#include <array>
#include <string>
#include <vector>

#include <imgui.h>

#include "viewer/ui/on_screen.h"
#include "viewer/window/panels/panels.h"

namespace lucarne::viewer {
namespace {

struct Line {
    const std::string* text;
    bool is_problem;
};

/// Room that the coordinates under the cursor usually take.
float coordinates_width() {
    return ImGui::CalcTextSize("-0000000.000  -0000000.000  0000.000").x +
           3 * ImGui::GetStyle().WindowPadding.x;
}

}  // namespace

void draw_message(const ViewModel& model, bool busy) {
    static const std::string kBusy = "Rendering";
    const Health& health = model.health;
    std::vector<Line> lines;
    for (const std::string* problem : {&health.device, &health.shaders, &health.picture, &health.nodes})
        if (!problem->empty()) lines.push_back({problem, true});
    if (!model.view.message.empty() || busy)
        lines.push_back({model.view.message.empty() ? &kBusy : &model.view.message, false});
    if (lines.empty()) return;

    // The plate's size comes from the text: ImGui's own would be that of the last text for a frame, and the
    // window draws no further frame while nothing happens.
    const ImGuiStyle& style = ImGui::GetStyle();
    const ImVec2 size = ImGui::GetIO().DisplaySize;
    const auto left = static_cast<float>(model.view.side_bar.pixels(ImGui::GetFontSize(), size.x));
    const float edge = scaled(8);
    const float widest = std::max(size.x - left - 2 * edge - 2 * style.WindowPadding.x, 1.0f);
    ImVec2 plate(0, -style.ItemSpacing.y);
    for (const Line& line : lines) {
        const ImVec2 text = ImGui::CalcTextSize(line.text->c_str(), nullptr, false, widest);
        plate = {std::max(plate.x, text.x), plate.y + text.y + style.ItemSpacing.y};
    }
    plate = {plate.x + 2 * style.WindowPadding.x, plate.y + 2 * style.WindowPadding.y};
    // A long text goes above the row of the coordinates and of the sign of convergence.
    const float middle = (left + size.x) / 2;
    const bool beside = middle + plate.x / 2 <= convergence_left() - coordinates_width();
    const float row = ImGui::GetTextLineHeight() + 2 * style.WindowPadding.y + edge;
    ImGui::SetNextWindowPos(ImVec2(middle, size.y - edge - (beside ? 0 : row)), ImGuiCond_Always,
                            ImVec2(0.5f, 1.0f));
    ImGui::SetNextWindowSize(plate);
    ImGui::SetNextWindowBgAlpha(0.85f);  // a long text may lie over the scale bar
    const ImGuiWindowFlags flags = ImGuiWindowFlags_NoDecoration | ImGuiWindowFlags_NoInputs |
                                   ImGuiWindowFlags_NoFocusOnAppearing | ImGuiWindowFlags_NoNav;
    if (ImGui::Begin("##message", nullptr, flags)) {
        ImGui::PushTextWrapPos(style.WindowPadding.x + widest);
        for (const Line& line : lines) {
            if (line.is_problem) ImGui::PushStyleColor(ImGuiCol_Text, ImVec4(1.0f, 0.8f, 0.4f, 1.0f));
            ImGui::TextUnformatted(line.text->c_str());
            if (line.is_problem) ImGui::PopStyleColor();
        }
        ImGui::PopTextWrapPos();
    }
    ImGui::End();
}

}  // namespace lucarne::viewer
