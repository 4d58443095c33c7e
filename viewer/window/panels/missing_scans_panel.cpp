// The question where a project's scans are.
#include <algorithm>

#include <imgui.h>
#include <imgui_stdlib.h>

#include "viewer/ui/popups.h"
#include "viewer/window/panels/panels.h"

namespace lucarne::viewer {

void draw_missing_scans(MissingScans& question) {
    constexpr const char* kTitle = "Where are these scans?";
    constexpr size_t kMostListed = 8;
    if (!begin_question(kTitle, question.shown)) return;
    const float room = ImGui::GetIO().DisplaySize.x;
    const float width = std::min(36 * ImGui::GetFontSize(), room - 4 * ImGui::GetFontSize());
    ImGui::PushTextWrapPos(width);
    ImGui::Text("%s needs:", question.project.filename().c_str());
    const size_t listed = std::min(question.paths.size(), kMostListed);
    for (size_t i = 0; i < listed; ++i) ImGui::BulletText("%s", question.paths[i].c_str());
    if (listed < question.paths.size()) ImGui::BulletText("%zu more", question.paths.size() - listed);
    ImGui::TextUnformatted("Folder in which they are now:");
    ImGui::SetNextItemWidth(width);
    if (ImGui::IsWindowAppearing()) ImGui::SetKeyboardFocusHere();
    const bool entered = ImGui::InputText("##folder", &question.folder, ImGuiInputTextFlags_EnterReturnsTrue);
    if (!question.problem.empty()) ImGui::TextUnformatted(question.problem.c_str());
    ImGui::PopTextWrapPos();
    if ((ImGui::Button("Look there (Enter)") || entered) && !question.folder.empty())
        question.answer = question.folder;
    ImGui::SameLine();
    if (ImGui::Button("Browse...")) question.browses = true;
    ImGui::SameLine();
    const bool escape = ImGui::IsKeyPressed(ImGui::GetKeyIndex(ImGuiKey_Escape));
    if (ImGui::Button(question.others_open ? "Go on without (Escape)" : "Cancel (Escape)") || escape)
        question.shown = false;
    if (!question.shown) ImGui::CloseCurrentPopup();
    ImGui::EndPopup();
}

}  // namespace lucarne::viewer
