// The question whether to close the window, with a list of what would be lost.
#include <algorithm>

#include <imgui.h>

#include "viewer/scans/scan_set.h"
#include "viewer/ui/popups.h"
#include "viewer/window/panels/panels.h"
#include "viewer/window/unsaved.h"

namespace lucarne::viewer {
namespace {

void list_unsaved(const std::vector<Unsaved>& all) {
    ImGui::TextUnformatted("Not saved yet:");
    for (const Unsaved& one : all) {
        ImGui::BulletText("%s", one.what.c_str());
        ImGui::Indent();
        ImGui::TextDisabled("to be saved as %s", one.file.lexically_normal().c_str());
        ImGui::Unindent();
    }
}

void list_running(const ViewModel& model) {
    if (model.publish.rendering.running)
        ImGui::Text("%s is not finished, and would be given up.", model.publish.rendering.file.c_str());
    if (model.exporting.running) ImGui::TextUnformatted("The export is not finished, and would be given up.");
    if (model.scans && model.scans->converting())
        ImGui::TextUnformatted(
            "A scan is being converted. What is finished of it is kept: the conversion goes on from there "
            "when the scan "
            "is opened again.");
}

void buttons(ClosingQuestion& question, bool any_unsaved) {
    if (ImGui::Button(any_unsaved ? "Save (Enter)" : "Close now (Enter)"))
        any_unsaved ? question.answers.push(SaveAndClose{}) : question.answers.push(DiscardAndClose{});
    ImGui::SameLine();
    if (any_unsaved) {
        if (ImGui::Button("Discard (Ctrl+D)")) question.answers.push(DiscardAndClose{});
        ImGui::SameLine();
    }
    if (ImGui::Button(any_unsaved ? "Cancel (Escape)" : "Stay (Escape)")) question.shown = false;
}

}  // namespace

void draw_closing_question(ViewModel& model) {
    constexpr const char* kName = "Close Lucarne?";
    ClosingQuestion& question = model.closing;
    if (!begin_question(kName, question.shown)) return;
    const float room = ImGui::GetIO().DisplaySize.x;
    const std::vector<Unsaved> all = work_to_lose(model);
    ImGui::PushTextWrapPos(std::min(40 * ImGui::GetFontSize(), room - 4 * ImGui::GetFontSize()));
    if (!all.empty()) list_unsaved(all);
    list_running(model);
    if (!question.problem.empty()) {
        ImGui::PushStyleColor(ImGuiCol_Text, ImVec4(1, 0.5f, 0.4f, 1));
        ImGui::TextUnformatted(question.problem.c_str());
        ImGui::PopStyleColor();
    }
    ImGui::PopTextWrapPos();
    ImGui::Spacing();
    buttons(question, !all.empty());
    if (!question.shown) ImGui::CloseCurrentPopup();
    ImGui::EndPopup();
}

}  // namespace lucarne::viewer
