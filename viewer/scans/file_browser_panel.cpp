#include <cfloat>

#include <imgui.h>
#include <imgui_stdlib.h>

#include "io/core/options.h"
#include "viewer/scans/file_browser.h"
#include "viewer/scans/scan_commands.h"

namespace lucarne::viewer {
namespace {

void entries(FileBrowser& browser, ScanCommands& commands) {
    const FolderListing listing = browser.listing();
    if (!listing.problem.empty()) ImGui::TextWrapped("%s", listing.problem.c_str());
    if (listing.folder != browser.folder()) return ImGui::TextDisabled("...");
    ImGuiListClipper clipper;
    clipper.Begin(static_cast<int>(listing.entries.size()));
    while (clipper.Step())
        for (int i = clipper.DisplayStart; i < clipper.DisplayEnd; ++i) {
            const FolderEntry& entry = listing.entries[static_cast<size_t>(i)];
            const std::string label = entry.folder ? entry.name + "/" : entry.name;
            const bool picked = ImGui::Selectable(label.c_str(), browser.is_chosen(entry.name),
                                                  ImGuiSelectableFlags_AllowDoubleClick);
            if (!entry.folder) {
                ImGui::SameLine(ImGui::GetWindowContentRegionMax().x - 6 * ImGui::GetFontSize());
                ImGui::TextDisabled("%s", bytes_text(entry.bytes).c_str());
            }
            const bool twice = picked && ImGui::IsMouseDoubleClicked(ImGuiMouseButton_Left);
            if (twice && entry.folder) return browser.go(browser.folder() / entry.name);
            if (twice) {
                commands.push(OpenFiles{{(browser.folder() / entry.name).string()}});
                return browser.close();
            }
            if (picked) browser.toggle(entry.name);
        }
}

/// Draws the field for a path. Returns true if a file was typed, which is opened.
bool type_path(FileBrowser& browser, ScanCommands& commands) {
    std::string typed = browser.folder().string();
    ImGui::SetNextItemWidth(-FLT_MIN);
    if (ImGui::IsWindowAppearing()) ImGui::SetKeyboardFocusHere();
    if (!ImGui::InputText("##path", &typed, ImGuiInputTextFlags_EnterReturnsTrue)) return false;
    ImGui::SetKeyboardFocusHere(-1);  // to go on typing
    const auto file = browser.enter(typed);
    if (file) commands.push(OpenFiles{{*file}});
    return file.has_value();
}

}  // namespace

void draw_file_browser(FileBrowser& browser, ScanCommands& commands) {
    if (!browser.is_open()) return;
    const ImVec2 size = ImGui::GetIO().DisplaySize;
    const float font = ImGui::GetFontSize();
    ImGui::SetNextWindowPos(ImVec2(size.x / 2, size.y / 2), ImGuiCond_Appearing, ImVec2(0.5f, 0.5f));
    ImGui::SetNextWindowSize(ImVec2(std::min(size.x - 16, font * 44), std::min(size.y - 60, font * 32)),
                             ImGuiCond_Appearing);
    ImGui::SetNextWindowBgAlpha(1);
    bool open = true;
    if (ImGui::Begin("Open scans", &open)) {
        if (ImGui::Button("Up")) browser.go(browser.folder().parent_path());
        ImGui::SameLine();
        if (type_path(browser, commands)) open = false;
        if (!browser.problem().empty()) ImGui::TextWrapped("%s", browser.problem().c_str());
        if (ImGui::BeginChild("entries", ImVec2(0, -2 * ImGui::GetFrameHeight()), true))
            entries(browser, commands);
        ImGui::EndChild();
        bool all = browser.shows_all();
        if (ImGui::Checkbox("All files", &all)) browser.show_all(all);
        ImGui::SameLine();
        const std::vector<std::string> chosen = browser.chosen();
        const bool here = chosen.empty();
        if (ImGui::Button(here ? "Open the whole folder" : "Open")) {
            commands.push(OpenFiles{here ? std::vector{browser.folder().string()} : chosen});
            open = false;
        }
        ImGui::SameLine();
        if (ImGui::Button("Cancel") || ImGui::IsKeyPressed(ImGui::GetKeyIndex(ImGuiKey_Escape))) open = false;
    }
    ImGui::End();
    if (!open) browser.close();
}

}  // namespace lucarne::viewer
