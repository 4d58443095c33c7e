#include "viewer/window/point_export.h"

#include <algorithm>
#include <system_error>
#include <utility>

#include <fmt/format.h>
#include <imgui.h>

#include "io/core/log.h"
#include "io/files/file.h"
#include "io/formats/scan.h"
#include "viewer/scans/scan_set.h"
#include "viewer/ui/on_screen.h"
#include "viewer/ui/widgets.h"

namespace lucarne::viewer {

/// Errors: several scans are shown, which have no common file, or parts of one are still to come; the file is
/// one of the open scans; it cannot be written.
Result<void> PointExport::start(const FileQuestion::Answer& answer) {
    const std::string file = answer.file.string();
    const auto& source = model_.scans->source();
    if (!source) return failed(file, "no scan is shown", "open one first");
    const auto& rows = model_.scans->rows();
    if (source->roots().size() > 1)
        return failed(file, "several scans are shown", "hide all but one in the section Scans");
    for (const ScanRow& row : rows) {
        if (row.visible && row.state != ScanState::whole && row.state != ScanState::failed)
            return failed(file, "the scan is not converted yet", "wait, or resume the conversion");
        for (const std::string& path : row.paths) {
            std::error_code neither_is_there;
            if (std::filesystem::equivalent(answer.file, path, neither_is_there))
                return failed(file, "is an open scan, which would be lost", "give another name");
        }
    }
    LUCARNE_TRY(check_output(answer.file, answer.overwrite));
    const ExportChoice& choice = model_.exporting;
    const auto every = static_cast<uint64_t>(std::max(choice.every, 1));
    if (!worker_.start({source, model_.view.scene.look, answer.file, answer.overwrite,
                        std::max<double>(choice.spacing, 0), every}))
        return failed(worker_.state().file, "is still being exported", "wait, or cancel it");
    return {};
}

void PointExport::follow() {
    ExportChoice& choice = model_.exporting;
    if (auto outcome = worker_.take_outcome()) {
        model_.view.message = *outcome ? std::move(**outcome) : outcome->error().line();
        log::info("{}", model_.view.message);
    }
    if (const auto answer = choice.name.take_answer()) {
        const auto started = start(*answer);
        choice.name.problem = started ? "" : started.error().line();
        choice.name.shown = !started;
    }
    if (std::exchange(choice.cancel, false)) worker_.cancel();
    choice.running = worker_.state().running;
}

void PointExport::draw() {
    ExportChoice& choice = model_.exporting;
    draw_file_question("Export points", choice.name, [&] {
        ImGui::TextDisabled("As .las, .laz, .copc.laz, .ply, .pcd, .csv, .txt or .xyz");
        const auto field = [](const char* text) {
            LeftLabel label(text, 13);
            ImGui::SetNextItemWidth(8 * ImGui::GetFontSize());
            return label;
        };
        ImGui::InputDouble(field("Spacing, m (0: all points)"), &choice.spacing, 0, 0, "%.4g");
        choice.spacing = std::clamp(choice.spacing, 0.0, 1e6);
        ImGui::InputInt(field("Every n-th point"), &choice.every);
        choice.every = std::clamp(choice.every, 1, 1'000'000'000);
    });
    const ExportState state = worker_.state();
    if (!state.running) return;
    const ImVec2 size = ImGui::GetIO().DisplaySize;
    ImGui::SetNextWindowPos(ImVec2(size.x - scaled(8), size.y - 5 * ImGui::GetFrameHeight()),
                            ImGuiCond_Always, ImVec2(1, 1));
    const ImGuiWindowFlags flags = ImGuiWindowFlags_NoDecoration | ImGuiWindowFlags_AlwaysAutoResize |
                                   ImGuiWindowFlags_NoFocusOnAppearing | ImGuiWindowFlags_NoNav |
                                   ImGuiWindowFlags_NoMove;
    if (ImGui::Begin("##export", nullptr, flags)) {
        const std::string name = std::filesystem::path(state.file).filename().string();
        ImGui::ProgressBar(static_cast<float>(state.share), ImVec2(14 * ImGui::GetFontSize(), 0),
                           fmt::format("exporting {:.0f} %", 100 * state.share).c_str());
        ImGui::SameLine();
        if (ImGui::Button("Cancel")) choice.cancel = true;
        ImGui::TextUnformatted(name.c_str());
    }
    ImGui::End();
}

}  // namespace lucarne::viewer
