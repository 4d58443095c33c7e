#include <imgui.h>

#include "viewer/window/panels/panels.h"

namespace lucarne::viewer {
namespace {

constexpr size_t kMostShown = 8;  ///< recent files

void recent_files(ViewModel& model) {
    if (model.settings.recent.empty()) return;
    ImGui::Spacing();
    ImGui::TextDisabled("Recent");
    for (size_t i = 0; i < std::min(model.settings.recent.size(), kMostShown); ++i) {
        ImGui::PushID(static_cast<int>(i));
        if (ImGui::Selectable(model.settings.recent[i].c_str()))
            model.scan_commands.push(OpenFiles{{model.settings.recent[i]}});
        ImGui::PopID();
    }
}

}  // namespace

void draw_start_page(ViewModel& model) {
    const ImVec2 size = ImGui::GetIO().DisplaySize;
    const float font = ImGui::GetFontSize();
    ImGui::SetNextWindowPos(ImVec2(size.x / 2, size.y / 2), ImGuiCond_Always, ImVec2(0.5f, 0.5f));
    ImGui::SetNextWindowSize(ImVec2(std::min(size.x - 16, font * 40), 0), ImGuiCond_Always);
    const ImGuiWindowFlags flags =
        ImGuiWindowFlags_NoDecoration | ImGuiWindowFlags_NoMove | ImGuiWindowFlags_NoBringToFrontOnFocus;
    if (ImGui::Begin("##start", nullptr, flags)) {
        ImGui::TextUnformatted("Lucarne lets light into scans.");
        ImGui::Spacing();
        ImGui::TextWrapped(
            "Drop scan files or folders here, or open them. They are shown at once and converted in the "
            "background; the cache is kept beside the scan, so the next time is faster.");
        ImGui::Spacing();
        if (ImGui::Button("Open scans...")) model.scan_commands.push(ChooseFiles{});
        ImGui::SameLine();
        ImGui::TextDisabled("Ctrl+O");
        ImGui::TextWrapped(
            "Lucarne's own caches (.luc), LAS, LAZ, COPC, E57, PLY, PCD, PTX, PTS, OBJ and text.");
        recent_files(model);
        ImGui::Spacing();
        ImGui::Separator();
        ImGui::BulletText(
            "Left drag rotates, right drag shifts, scrolling goes to what is under the cursor.");
        ImGui::BulletText(
            "End goes inside a building. There left drag looks round, double-click goes there.");
        ImGui::BulletText("The buttons over the picture choose the light: daylight, evening, museum...");
        ImGui::BulletText("F1 lists all keys; each is also in its menu.");
    }
    ImGui::End();
}

}  // namespace lucarne::viewer
