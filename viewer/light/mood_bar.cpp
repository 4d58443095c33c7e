// The moods as buttons over the picture, where a newcomer finds them.
#include <algorithm>

#include <imgui.h>

#include "viewer/light/lighting.h"
#include "viewer/opening/moods.h"
#include "viewer/ui/on_screen.h"

namespace lucarne::viewer {
namespace {

float width_of(std::span<const MoodInfo> all) {
    const ImGuiStyle& style = ImGui::GetStyle();
    float width = 2 * style.WindowPadding.x - style.ItemSpacing.x;
    for (const MoodInfo& info : all)
        width += ImGui::CalcTextSize(info.label.data()).x + 2 * style.FramePadding.x + style.ItemSpacing.x;
    return width;
}

}  // namespace

void draw_mood_bar(const Lighting& model) {
    if (model.view.site.outline.empty()) return;
    const ImVec2 size = ImGui::GetIO().DisplaySize;
    const auto left = static_cast<float>(model.view.side_bar.pixels(ImGui::GetFontSize(), size.x));
    const float width = width_of(moods());
    if (size.x - left < 1.2f * width) return;  // it would hide the picture; the menu has them as well
    ImGui::SetNextWindowPos(ImVec2((left + size.x - width) / 2, ImGui::GetFrameHeight() + scaled(6)));
    ImGui::SetNextWindowBgAlpha(0.45f);
    const ImGuiWindowFlags flags = ImGuiWindowFlags_NoDecoration | ImGuiWindowFlags_AlwaysAutoResize |
                                   ImGuiWindowFlags_NoFocusOnAppearing | ImGuiWindowFlags_NoNav |
                                   ImGuiWindowFlags_NoMove;
    if (ImGui::Begin("##moods", nullptr, flags))
        for (const MoodInfo& info : moods()) {
            if (info.mood != moods().front().mood) ImGui::SameLine();
            const bool lit = model.view.method.engine != engine_of(Mood::scan_colours);
            const bool chosen = model.lights.mood == info.mood && lit == (info.mood != Mood::scan_colours);
            if (chosen)
                ImGui::PushStyleColor(ImGuiCol_Button, ImGui::GetStyleColorVec4(ImGuiCol_ButtonActive));
            if (ImGui::Button(info.label.data())) take_mood(model, info.mood);
            if (chosen) ImGui::PopStyleColor();
            if (ImGui::IsItemHovered()) ImGui::SetTooltip("%s", info.help.data());
        }
    ImGui::End();
}

}  // namespace lucarne::viewer
