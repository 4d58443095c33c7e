#include <fmt/format.h>
#include <imgui.h>

#include "io/core/options.h"
#include "viewer/scans/scan_commands.h"
#include "viewer/scans/scan_set.h"

namespace lucarne::viewer {
namespace {

std::string points_text(uint64_t points) {
    if (points >= 1'000'000) return fmt::format("{:.1f} M", static_cast<double>(points) / 1e6);
    if (points >= 1000) return fmt::format("{:.1f} k", static_cast<double>(points) / 1e3);
    return std::to_string(points);
}

void tip(const std::string& text) {
    if (!ImGui::IsItemHovered()) return;
    ImGui::BeginTooltip();
    ImGui::TextUnformatted(text.c_str());
    ImGui::EndTooltip();
}

/// Draws the progress bar with a button to cancel. Shows why work failed or was stopped.
void progress(ScanSet& scans, const ScanRow& row) {
    const float button = ImGui::GetFontSize() * 4.5f;
    if (row.state == ScanState::elsewhere) {
        ImGui::TextWrapped("Another window or program converts it");
    } else if (row.busy()) {
        const bool waits = row.state == ScanState::sample;
        const std::string text = waits ? "Queued" : fmt::format("{} {:.0f} %", row.stage, 100 * row.share);
        ImGui::ProgressBar(waits ? 0.0f : static_cast<float>(row.share), ImVec2(-button, 0), text.c_str());
        ImGui::SameLine();
        if (ImGui::SmallButton("Cancel")) scans.stop(row.id);
    } else if (row.state == ScanState::stopped) {
        ImGui::TextUnformatted("Conversion incomplete");
        ImGui::SameLine();
        if (ImGui::SmallButton("Resume")) scans.go_on(row.id);
    }
    if (row.error) {
        ImGui::PushStyleColor(ImGuiCol_Text, ImVec4(1, 0.5f, 0.4f, 1));
        ImGui::TextWrapped("%s", row.error->line().c_str());
        ImGui::PopStyleColor();
    }
}

void files(const ScanRow& row) {
    for (size_t i = 0; i < row.paths.size(); ++i) {
        const size_t slash = row.paths[i].find_last_of('/');
        ImGui::BulletText("%s", row.paths[i].c_str() + (slash == std::string::npos ? 0 : slash + 1));
        if (i >= row.of_path.size()) continue;
        ImGui::SameLine();
        ImGui::TextDisabled("%s", points_text(row.of_path[i]).c_str());
    }
}

/// Returns the number of points and the size on disk, as far as they are known.
std::string figures(const ScanRow& row) {
    std::string text = row.points ? points_text(row.points) + " points" : "";
    if (row.file_bytes) text += (text.empty() ? "" : ", ") + bytes_text(row.file_bytes) + " on disk";
    return text;
}

void draw_row(ScanSet& scans, const ScanRow& row, ScanCommands& commands) {
    const float font = ImGui::GetFontSize(), button = ImGui::GetContentRegionMax().x - 1.5f * font;
    ImGui::PushID(static_cast<int>(row.id));
    if (row.state != ScanState::failed) {
        bool visible = row.visible;
        if (ImGui::Checkbox("##visible", &visible)) scans.set_visible(row.id, visible);
        tip("drawn or not");
        ImGui::SameLine();
    }
    const bool tree = row.paths.size() > 1;
    const ImGuiTreeNodeFlags leaf = ImGuiTreeNodeFlags_Leaf | ImGuiTreeNodeFlags_NoTreePushOnOpen;
    const ImVec2 corner = ImGui::GetCursorScreenPos();  // long names are cut off at the button
    const float end = ImGui::GetWindowPos().x + button - 0.5f * font;
    ImGui::PushClipRect(corner, ImVec2(end, corner.y + ImGui::GetFrameHeight()), true);
    const bool open = ImGui::TreeNodeEx("##name", tree ? 0 : leaf, "%s", row.name().c_str());
    ImGui::PopClipRect();
    const bool twice = ImGui::IsItemHovered() && ImGui::IsMouseDoubleClicked(ImGuiMouseButton_Left);
    if (twice && row.box) commands.push(LookAtScan{*row.box});
    tip(fmt::format("{}\n{} on disk; its directory takes {} of memory\ndouble-click: show all of it",
                    row.paths.front(), bytes_text(row.file_bytes), bytes_text(row.memory)));
    ImGui::SameLine(button);
    const bool close = ImGui::SmallButton("x");
    tip("close it");
    if (const std::string text = figures(row); !text.empty()) ImGui::TextDisabled("   %s", text.c_str());
    if (tree && open) {
        files(row);
        ImGui::TreePop();
    }
    progress(scans, row);
    ImGui::PopID();
    if (close) scans.remove(row.id);
}

}  // namespace

void draw_scans_panel(ScanSet& scans, ScanCommands& commands) {
    const std::vector<ScanRow> rows = scans.rows();  // a copy: a row may be removed while the rows are drawn
    for (const ScanRow& row : rows) draw_row(scans, row, commands);
}

}  // namespace lucarne::viewer
