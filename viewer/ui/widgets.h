#pragma once

#include <algorithm>
#include <string>

#include <imgui.h>

namespace lucarne::viewer {

/// Draws the heading of a collapsible part of a section. Returns whether the part is open.
inline bool fold(const char* label) {
    return ImGui::TreeNodeEx(label, ImGuiTreeNodeFlags_NoTreePushOnOpen | ImGuiTreeNodeFlags_SpanAvailWidth);
}

/// The label of the next widget, drawn on its left: ImGui::SliderFloat(LeftLabel("Scale"), ...).
class LeftLabel {
 public:
    /// `column`: width of the column of labels in characters' heights; longer labels take what they need.
    explicit LeftLabel(const std::string& label, float column = 7.5f) : id_("##" + label) {
        ImGui::AlignTextToFramePadding();
        ImGui::TextUnformatted(label.c_str());
        ImGui::SameLine();
        ImGui::SetCursorPosX(std::max(ImGui::GetCursorPosX(),
                                      ImGui::GetStyle().WindowPadding.x + column * ImGui::GetFontSize()));
        ImGui::SetNextItemWidth(-1.5f * ImGui::GetFontSize());  // leaves room for "?"
    }
    /// The widget's own label, which is not shown.
    operator const char*() const { return id_.c_str(); }

 private:
    std::string id_;
};

/// Draws a "?" behind the last item, which explains it to the mouse.
inline void help_mark(const char* text) {
    ImGui::SameLine(0, ImGui::GetStyle().ItemInnerSpacing.x);
    ImGui::TextDisabled("?");
    if (ImGui::IsItemHovered()) ImGui::SetTooltip("%s", text);
}

}  // namespace lucarne::viewer
