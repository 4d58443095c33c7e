#pragma once

#include <imgui.h>

namespace lucarne::viewer {

/// Draws the heading of a collapsible part of a section. Returns whether the part is open.
inline bool fold(const char* label) {
    return ImGui::TreeNodeEx(label, ImGuiTreeNodeFlags_NoTreePushOnOpen | ImGuiTreeNodeFlags_SpanAvailWidth);
}

}  // namespace lucarne::viewer
