// The bar that contains all panels, so that no panel covers another and all can be reached in a small window.
#include <algorithm>
#include <array>
#include <cmath>

#include <imgui.h>

#include "viewer/scans/scan_set.h"
#include "viewer/window/panels/panels.h"

namespace lucarne::viewer {
namespace {

struct SectionEntry {
    const char* title;
    void (*draw)(ViewModel& model);
    bool needs_view;
};
/// In the order of `BarSection`.
constexpr std::array<SectionEntry, kSections> kEntries = {{
    {"Scans", [](ViewModel& model) { draw_scans_panel(*model.scans, model.scan_commands); }, false},
    {"Rendering", [](ViewModel& model) { draw_rendering_panel(model.rendering()); }, true},
    {"Appearance", [](ViewModel& model) { draw_look_panel(model.styling()); }, true},
    {"Light", [](ViewModel& model) { draw_light_panel(model.lighting()); }, true},
    {"Measure", [](ViewModel& model) { draw_measure_panel(model.measuring()); }, true},
    {"Bookmarks", [](ViewModel& model) { draw_bookmarks_panel(model.bookmarking()); }, true},
    {"Flythrough", [](ViewModel& model) { draw_flythrough_panel(model.publishing()); }, true},
    {"Save a picture", [](ViewModel& model) { draw_picture_panel(model.publishing()); }, true},
    {"Statistics", [](ViewModel& model) { draw_statistics_panel(model); }, true},
    {"6-DoF controller", draw_controller_panel, false},
    {"Preferences", draw_preferences_panel, false},
}};

/// Returns whether a section is shown. With nothing open there is only the start page, and sections that need
/// no scan if the user opened them.
bool is_there(const ViewModel& model, BarSection section, bool has_view) {
    if (section == BarSection::scans) return model.scans && (has_view || !model.scans->rows().empty());
    if (has_view) return true;
    return !kEntries[static_cast<size_t>(section)].needs_view && model.view.side_bar.is_open(section);
}

void draw_section(ViewModel& model, BarSection section) {
    SideBar& bar = model.view.side_bar;
    const SectionEntry& entry = kEntries[static_cast<size_t>(section)];
    bool& open = bar.open[static_cast<size_t>(section)];
    if (bar.sought == section) {
        ImGui::SetScrollHereY(0);
        bar.sought.reset();
    }
    ImGui::SetNextItemOpen(open);
    open = ImGui::CollapsingHeader(entry.title);
    if (!open) return;
    ImGui::PushID(entry.title);
    entry.draw(model);
    ImGui::PopID();
    ImGui::Spacing();
}

}  // namespace

void draw_side_bar(ViewModel& model, bool has_view) {
    SideBar& bar = model.view.side_bar;
    bool any = false;
    for (size_t i = 0; i < kSections; ++i) any = any || is_there(model, static_cast<BarSection>(i), has_view);
    if (!bar.shown || !any) return;
    const ImVec2 window = ImGui::GetIO().DisplaySize;
    const float font = ImGui::GetFontSize(), top = ImGui::GetFrameHeight(), height = window.y - top;
    const auto width = static_cast<float>(bar.pixels(font, window.x));
    ImGui::SetNextWindowPos(ImVec2(0, top));
    ImGui::SetNextWindowSize(ImVec2(width, height));
    // Its right edge can be dragged, its height cannot.
    const auto widest = static_cast<float>(SideBar{.width = SideBar::kMost}.pixels(font, window.x));
    const float narrowest = std::min(static_cast<float>(SideBar::kLeast) * font, widest);
    ImGui::SetNextWindowSizeConstraints(ImVec2(narrowest, height), ImVec2(widest, height));
    ImGui::PushStyleVar(ImGuiStyleVar_WindowRounding, 0);
    ImGuiWindowFlags flags = ImGuiWindowFlags_NoTitleBar | ImGuiWindowFlags_NoMove |
                             ImGuiWindowFlags_NoCollapse | ImGuiWindowFlags_NoBringToFrontOnFocus |
                             ImGuiWindowFlags_AlwaysVerticalScrollbar;
    // Tab is the key of an action: it moves between fields only while a field is active.
    if (!ImGui::IsAnyItemActive()) flags |= ImGuiWindowFlags_NoNavInputs;
    if (ImGui::Begin("##side bar", nullptr, flags)) {
        const float dragged = ImGui::GetWindowWidth();
        // ImGui rounds sizes down. So count a change as the user's only if the mouse is pressed and it is at
        // least one pixel.
        if (ImGui::IsMouseDown(ImGuiMouseButton_Left) && std::abs(dragged - width) >= 1)
            bar.width = std::clamp(static_cast<double>(dragged / font), SideBar::kLeast, SideBar::kMost);
        ImGui::PushItemWidth(-1.5f * font);  // leaves room for "?"
        for (size_t i = 0; i < kSections; ++i)
            if (is_there(model, static_cast<BarSection>(i), has_view))
                draw_section(model, static_cast<BarSection>(i));
        ImGui::PopItemWidth();
    }
    ImGui::End();
    ImGui::PopStyleVar();
}

}  // namespace lucarne::viewer
