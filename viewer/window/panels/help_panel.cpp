#include <imgui.h>

#include "viewer/window/actions/actions.h"
#include "viewer/window/panels/panels.h"

namespace lucarne::viewer {
namespace {

void topic(std::string_view name) {
    ImGui::TableNextRow();
    ImGui::TableNextColumn();
    ImGui::Spacing();
    ImGui::TextDisabled("%.*s", static_cast<int>(name.size()), name.data());
    ImGui::TableNextColumn();
}

/// The menu bar's title under which an action is.
std::string_view title_of(const BoundAction& action) {
    const std::string_view menu = action.menu;
    return menu.substr(0, menu.find('/'));
}

void row(const char* key, const char* what) {
    ImGui::TableNextColumn();
    ImGui::TextUnformatted(key);
    ImGui::TableNextColumn();
    ImGui::TextUnformatted(what);
}

}  // namespace

void draw_help(bool& shown, std::span<const BoundAction> actions) {
    const ImVec2 size = ImGui::GetIO().DisplaySize;
    ImGui::SetNextWindowPos(ImVec2(size.x / 2, size.y / 2), ImGuiCond_Always, ImVec2(0.5f, 0.5f));
    ImGui::SetNextWindowBgAlpha(0.95f);
    ImGui::SetNextWindowSizeConstraints(ImVec2(0, 0), ImVec2(size.x, size.y - 4 * ImGui::GetFontSize()));
    const ImGuiWindowFlags flags =
        ImGuiWindowFlags_AlwaysAutoResize | ImGuiWindowFlags_NoCollapse | ImGuiWindowFlags_NoMove;
    if (ImGui::Begin("Keys and mouse", &shown, flags) &&
        ImGui::BeginTable("keys", 2, ImGuiTableFlags_SizingFixedFit)) {
        topic("Mouse");
        for (const Gesture& gesture : gestures()) row(gesture.gesture, gesture.what);
        std::string_view last;
        for (const BoundAction& action : actions) {
            if (title_of(action) != last) topic(last = title_of(action));
            std::string keys = key_text(action.chord);
            if (action.other.key != 0) keys += ", " + key_text(action.other);
            row(keys.c_str(), action.name);
        }
        ImGui::EndTable();
    }
    ImGui::End();
    if (ImGui::IsKeyPressed(ImGui::GetKeyIndex(ImGuiKey_Escape))) shown = false;
}

void draw_about(bool& shown) {
    const ImVec2 size = ImGui::GetIO().DisplaySize;
    ImGui::SetNextWindowPos(ImVec2(size.x / 2, size.y / 2), ImGuiCond_Always, ImVec2(0.5f, 0.5f));
    const ImGuiWindowFlags flags =
        ImGuiWindowFlags_AlwaysAutoResize | ImGuiWindowFlags_NoCollapse | ImGuiWindowFlags_NoMove;
    if (ImGui::Begin("About Lucarne", &shown, flags)) {
        ImGui::TextUnformatted("Lucarne " LUCARNE_VERSION);
        ImGui::TextUnformatted("Point clouds of any size with global illumination.");
        ImGui::TextUnformatted("Apache License 2.0; without warranty.");
        ImGui::Spacing();
        ImGui::TextUnformatted("Global illumination after Preiner 2010.");
        ImGui::TextUnformatted(
            "Uses GLFW, Dear ImGui, GLM, PCL, FLANN, PoCL, libusb and others; see README.md.");
    }
    ImGui::End();
    if (ImGui::IsKeyPressed(ImGui::GetKeyIndex(ImGuiKey_Escape))) shown = false;
}

}  // namespace lucarne::viewer
