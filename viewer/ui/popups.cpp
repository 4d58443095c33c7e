#include "viewer/ui/popups.h"

// ImGui's public functions close only the popup that is being drawn.
#include <imgui.h>
#include <imgui_internal.h>

namespace lucarne::viewer {

bool close_popups() {
    const ImVector<ImGuiPopupData>& open = ImGui::GetCurrentContext()->OpenPopupStack;
    int level = open.Size;
    while (level > 0 && !(open[level - 1].Window && (open[level - 1].Window->Flags & ImGuiWindowFlags_Modal)))
        --level;
    if (level == open.Size) return false;
    ImGui::ClosePopupToLevel(level, true);
    return true;
}

bool begin_question(const char* title, bool shown) {
    if (shown && !ImGui::IsPopupOpen(title)) ImGui::OpenPopup(title);
    const ImVec2 size = ImGui::GetIO().DisplaySize;
    ImGui::SetNextWindowPos(ImVec2(size.x / 2, size.y / 2), ImGuiCond_Always, ImVec2(0.5f, 0.5f));
    return ImGui::BeginPopupModal(
        title, nullptr,
        ImGuiWindowFlags_AlwaysAutoResize | ImGuiWindowFlags_NoCollapse | ImGuiWindowFlags_NoMove);
}

}  // namespace lucarne::viewer
