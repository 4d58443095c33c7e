#include <fmt/format.h>
#include <imgui.h>

#include "io/core/options.h"
#include "viewer/panels/panels.h"
#include "viewer/shell/scan_set.h"

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

/// Its bar with a button that ends it; what ended badly or early says so.
void progress(ScanSet& scans, const ScanRow& row) {
    const float button = ImGui::GetFontSize() * 4.5f;
    if (row.busy()) {
        const bool waits = row.state == ScanState::sample;
        const std::string text =
            waits ? "waits to be converted" : fmt::format("{} {:.0f} %", row.stage, 100 * row.share);
        ImGui::ProgressBar(waits ? 0.0f : static_cast<float>(row.share), ImVec2(-button, 0), text.c_str());
        ImGui::SameLine();
        if (ImGui::SmallButton("Cancel")) scans.stop(row.id);
    } else if (row.state == ScanState::stopped) {
        ImGui::TextUnformatted("not converted to its end");
        ImGui::SameLine();
        if (ImGui::SmallButton("Go on")) scans.go_on(row.id);
    }
    if (row.error) {
        ImGui::PushStyleColor(ImGuiCol_Text, ImVec4(1, 0.5f, 0.4f, 1));
        ImGui::TextWrapped("%s", row.error->line().c_str());
        ImGui::PopStyleColor();
    }
}

/// Where the columns behind the names begin, from the left.
struct Columns {
    float points, memory, close;
};
Columns columns() {
    const float font = ImGui::GetFontSize(), right = ImGui::GetWindowContentRegionMax().x;
    return {right - 12 * font, right - 7 * font, right - 1.5f * font};
}

void files(const ScanRow& row, const Columns& at) {
    for (size_t i = 0; i < row.paths.size(); ++i) {
        const size_t slash = row.paths[i].find_last_of('/');
        ImGui::BulletText("%s", row.paths[i].c_str() + (slash == std::string::npos ? 0 : slash + 1));
        if (i >= row.of_path.size()) continue;
        ImGui::SameLine(at.points);
        ImGui::TextUnformatted(points_text(row.of_path[i]).c_str());
    }
}

void draw_row(ScanSet& scans, const ScanRow& row) {
    const Columns at = columns();
    ImGui::PushID(static_cast<int>(row.id));
    bool visible = row.visible;
    if (ImGui::Checkbox("##visible", &visible)) scans.set_visible(row.id, visible);
    tip("drawn or not");
    ImGui::SameLine();
    const bool tree = row.paths.size() > 1;
    const ImGuiTreeNodeFlags leaf = ImGuiTreeNodeFlags_Leaf | ImGuiTreeNodeFlags_NoTreePushOnOpen;
    const bool open = ImGui::TreeNodeEx("##name", tree ? 0 : leaf, "%s", row.name().c_str());
    tip(fmt::format("{}\n{} on disk; its directory takes {} of memory", row.paths.front(),
                    bytes_text(row.file_bytes), bytes_text(row.memory)));
    ImGui::SameLine(at.points);
    ImGui::TextUnformatted(row.points ? points_text(row.points).c_str() : "");
    ImGui::SameLine(at.memory);
    ImGui::TextUnformatted(row.memory ? bytes_text(row.memory).c_str() : "");
    ImGui::SameLine(at.close);
    const bool close = ImGui::SmallButton("x");
    tip("close it");
    if (tree && open) {
        files(row, at);
        ImGui::TreePop();
    }
    progress(scans, row);
    ImGui::PopID();
    if (close) scans.remove(row.id);
}

}  // namespace

void draw_scans_panel(ViewModel& model) {
    ScanSet* scans = model.shell.scans;
    if (!scans || scans->rows().empty() || !model.shell.show_scans || !model.show_panels) return;
    const ImVec2 display = ImGui::GetIO().DisplaySize;
    const float font = ImGui::GetFontSize();
    ImGui::SetNextWindowPos(ImVec2(8, display.y - 8), ImGuiCond_FirstUseEver, ImVec2(0, 1));
    ImGui::SetNextWindowSize(ImVec2(font * 32, font * 11), ImGuiCond_FirstUseEver);
    if (ImGui::Begin("Scans", &model.shell.show_scans)) {
        const Columns at = columns();
        ImGui::TextDisabled("scan");
        ImGui::SameLine(at.points);
        ImGui::TextDisabled("points");
        ImGui::SameLine(at.memory);
        ImGui::TextDisabled("memory");
        const std::vector<ScanRow> rows = scans->rows();  // a row may go while they are drawn
        for (const ScanRow& row : rows) draw_row(*scans, row);
    }
    ImGui::End();
}

}  // namespace lucarne::viewer
