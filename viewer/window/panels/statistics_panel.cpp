#include <imgui.h>

#include "io/core/options.h"
#include "viewer/window/panels/panels.h"

namespace lucarne::viewer {
namespace {

void points_row(const char* name, uint64_t points) {
    ImGui::TableNextColumn();
    ImGui::TextUnformatted(name);
    ImGui::TableNextColumn();
    ImGui::Text("%.3f M", static_cast<double>(points) / 1e6);
}

void passes_table(const FrameStats& stats) {
    if (!ImGui::BeginTable("passes", 2)) return;
    for (const auto& pass : stats.passes) {
        ImGui::TableNextColumn();
        ImGui::TextUnformatted(pass.name.c_str());
        ImGui::TableNextColumn();
        ImGui::Text("%.1f ms", pass.seconds * 1e3);
    }
    points_row("view points", stats.view_points);
    points_row("light-view points", stats.light_view_points);
    points_row("light points", stats.light_points);
    for (const auto& [name, value] : stats.engine) {
        ImGui::TableNextColumn();
        ImGui::TextUnformatted(name.c_str());
        ImGui::TableNextColumn();
        ImGui::Text("%.6g", value);
    }
    ImGui::EndTable();
}

void draw_bake_progress(const BakeProgress& now) {
    ImGui::Text("Computed in advance: %.0f %%%s%s", now.share * 100, now.step.empty() ? "" : ", now ",
                now.step.c_str());
}

}  // namespace

void draw_statistics_panel(const ViewModel& model) {
    const FrameTimes& frames = model.health.frames;
    ImGui::Text("window: %.1f ms a frame, 95 %% within %.1f ms", frames.quantile(0.5) * 1e3,
                frames.quantile(0.95) * 1e3);
    const FrameTimes& pictures = model.health.pictures;
    if (pictures.frames() > 0)
        ImGui::Text("while moving: %.0f ms between pictures, 95 %% within %.0f ms",
                    pictures.quantile(0.5) * 1e3, pictures.quantile(0.95) * 1e3);
    if (model.view.picture) {
        const Picture& picture = *model.view.picture;
        const FrameStats& stats = picture.stats;
        ImGui::Text("%.1f ms a picture, %u x %u%s", stats.seconds * 1e3, picture.size.width,
                    picture.size.height, picture.moving ? ", moving" : "");
        ImGui::Text("cuts %.1f %% complete, %llu nodes to come", stats.complete() * 100,
                    static_cast<unsigned long long>(stats.nodes_pending));
        if (stats.nodes_lost > 0)
            ImGui::Text("%llu nodes left out: they cannot be read",
                        static_cast<unsigned long long>(stats.nodes_lost));
        if (!stats.not_prepared.empty())
            ImGui::TextWrapped("Not computed in advance: %s", stats.not_prepared.c_str());
        else if (stats.prepared)
            draw_bake_progress(stats.prepared == 1 ? BakeProgress{1, {}} : model.view.preparing);
        ImGui::Text("%u averaged, exposure %+.1f stops", stats.accumulated, picture.exposure_ev);
        ImGui::Text("loaded %s", bytes_text(stats.bytes_loaded).c_str());
        ImGui::Text("memory %s of %s", bytes_text(stats.memory.host).c_str(),
                    bytes_text(model.view.caps.memory).c_str());
        ImGui::Text("device %s of %s", bytes_text(stats.memory.device).c_str(),
                    bytes_text(model.view.caps.device_memory).c_str());
        ImGui::Text("Process memory %s", bytes_text(stats.memory.resident).c_str());
        passes_table(stats);
    } else {
        ImGui::TextUnformatted("The first picture is on its way.");
    }
    ImGui::TextDisabled("%s", model.view.device.renderer.c_str());
}

}  // namespace lucarne::viewer
