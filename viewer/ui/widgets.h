#pragma once

#include <imgui.h>

namespace lucarne::viewer {

/// Draws the heading of a collapsible part of a section. Returns whether the part is open.
inline bool fold(const char* label) {
    return ImGui::TreeNodeEx(label, ImGuiTreeNodeFlags_NoTreePushOnOpen | ImGuiTreeNodeFlags_SpanAvailWidth);
}

/// Draws a "?" behind the last item, which explains it to the mouse.
inline void help_mark(const char* text) {
    ImGui::SameLine(0, ImGui::GetStyle().ItemInnerSpacing.x);
    ImGui::TextDisabled("?");
    if (ImGui::IsItemHovered()) ImGui::SetTooltip("%s", text);
}

}  // namespace lucarne::viewer
