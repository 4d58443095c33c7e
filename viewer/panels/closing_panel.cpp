#include <imgui.h>

#include "viewer/panels/panels.h"

namespace lucarne::viewer {

void draw_closing_question(ViewModel& model) {
    if (!model.shell.ask_to_close) return;
    const ImVec2 size = ImGui::GetIO().DisplaySize;
    ImGui::SetNextWindowPos(ImVec2(size.x / 2, size.y / 2), ImGuiCond_Always, ImVec2(0.5f, 0.5f));
    const ImGuiWindowFlags flags =
        ImGuiWindowFlags_AlwaysAutoResize | ImGuiWindowFlags_NoCollapse | ImGuiWindowFlags_NoMove;
    const bool rendering = model.show.rendering.running;
    if (ImGui::Begin(rendering ? "A rendering goes on###closing" : "A scan is being converted###closing",
                     nullptr, flags)) {
        if (rendering)
            ImGui::Text("%s is not finished, and would be given up.", model.show.rendering.file.c_str());
        else
            ImGui::TextUnformatted(
                "What is finished of it is kept: the conversion goes on from there\nwhen the scan is opened "
                "again.");
        ImGui::Spacing();
        if (ImGui::Button("Close now (Enter)")) model.shell.close_now = true;
        ImGui::SameLine();
        if (ImGui::Button("Stay (Escape)")) model.shell.ask_to_close = false;
    }
    ImGui::End();
}

}  // namespace lucarne::viewer
