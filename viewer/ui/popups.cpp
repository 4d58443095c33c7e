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

}  // namespace lucarne::viewer
