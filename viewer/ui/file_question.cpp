#include "viewer/ui/file_question.h"

#include <algorithm>
#include <system_error>

#include <imgui.h>
#include <imgui_stdlib.h>

#include "viewer/ui/popups.h"

namespace lucarne::viewer {

void FileQuestion::confirm() {
    if (file.empty()) return;
    problem.clear();
    std::error_code unknown;
    if (!replaces && std::filesystem::exists(file, unknown)) {
        replaces = true;
        return;
    }
    answer = Answer{file, std::exchange(replaces, false)};
}

void draw_file_question(const char* title, FileQuestion& question, const std::function<void()>& fields) {
    if (!begin_question(title, question.shown)) return;
    const float room = ImGui::GetIO().DisplaySize.x;
    const float width = std::min(36 * ImGui::GetFontSize(), room - 4 * ImGui::GetFontSize());
    ImGui::PushTextWrapPos(width);
    ImGui::SetNextItemWidth(width);
    if (ImGui::IsWindowAppearing()) ImGui::SetKeyboardFocusHere();
    const std::string before = question.file;
    const bool entered = ImGui::InputText("##file", &question.file, ImGuiInputTextFlags_EnterReturnsTrue);
    if (question.file != before) question.replaces = false;
    if (entered) ImGui::SetKeyboardFocusHere(-1);  // so that Enter also answers the next question
    if (fields) fields();
    if (question.replaces) ImGui::TextUnformatted("This file exists. Replace it?");
    if (!question.problem.empty()) ImGui::TextUnformatted(question.problem.c_str());
    ImGui::PopTextWrapPos();
    if (ImGui::Button(question.replaces ? "Replace (Enter)" : "Save (Enter)") || entered) question.confirm();
    ImGui::SameLine();
    if (ImGui::Button("Cancel (Escape)") || ImGui::IsKeyPressed(ImGui::GetKeyIndex(ImGuiKey_Escape)))
        question.shown = false;
    if (!question.shown) ImGui::CloseCurrentPopup();
    ImGui::EndPopup();
}

}  // namespace lucarne::viewer
