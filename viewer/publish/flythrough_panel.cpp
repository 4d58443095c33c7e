// The panel of a flythrough's key frames, preview, files and rendering.
#include <algorithm>
#include <numbers>
#include <string>

#include <fmt/format.h>
#include <imgui.h>
#include <imgui_stdlib.h>

#include "viewer/publish/publishing.h"
#include "viewer/publish/render_progress.h"

namespace lucarne::viewer {
namespace {

constexpr double kDegrees = 180 / std::numbers::pi;

bool button(const char* label, bool enabled) {
    ImGui::BeginDisabled(!enabled);
    const bool pressed = ImGui::Button(label);
    ImGui::EndDisabled();
    return pressed;
}

void key_list(PublishModel& show) {
    if (!ImGui::BeginListBox("##keys", ImVec2(-1, ImGui::GetTextLineHeightWithSpacing() * 6))) return;
    const auto& keys = show.editor.path().keys;
    ImGuiListClipper clipper;
    clipper.Begin(static_cast<int>(keys.size()));
    while (clipper.Step())
        for (int row = clipper.DisplayStart; row < clipper.DisplayEnd; ++row) {
            const auto i = static_cast<size_t>(row);
            const KeyFrame& key = keys[i];
            const std::string text =
                fmt::format("{:>3}  {:8.2f} s  {:5.1f} deg  {:.6g} {:.6g} {:.6g}", i + 1, key.time,
                            key.camera.vertical_fov * kDegrees, key.camera.position.x, key.camera.position.y,
                            key.camera.position.z);
            ImGui::PushID(row);
            if (ImGui::Selectable(text.c_str(), show.editor.selected() == i)) show.go_to_key(i);
            ImGui::PopID();
        }
    ImGui::EndListBox();
}

void key_buttons(const Publishing& model) {
    PublishModel& show = model.publish;
    const bool one = show.editor.selected().has_value();
    if (button("Add", model.view.picture != nullptr)) show.add_key(model.view.rig.camera());
    ImGui::SameLine();
    if (button("Replace", one)) show.take(show.editor.replace(model.view.rig.camera()));
    ImGui::SameLine();
    if (button("Delete", one)) show.take(show.editor.remove());
    ImGui::SameLine();
    if (button("Undo", show.editor.can_undo())) show.editor.undo();
    if (button("Earlier", one)) show.take(show.editor.move(-1));
    ImGui::SameLine();
    if (button("Later", one)) show.take(show.editor.move(1));
    ImGui::SameLine();
    ImGui::Checkbox("draw the path", &show.draw_path);
}

/// A number field whose value is passed to `take` once the user leaves the field, so that a half-typed number
/// is no error. ImGui reports "changed" in every frame in which the text differs from `value`; the last such
/// number counts, unless the user restored the old one.
template <class Take>
void number_field(PublishModel& show, const char* label, double value, const Take& take) {
    if (ImGui::InputDouble(label, &value, 0, 0, "%.6g"))
        show.typed = value;
    else if (ImGui::IsItemActive() || ImGui::IsKeyPressed(ImGui::GetKeyIndex(ImGuiKey_Escape)))
        show.typed.reset();
    if (!ImGui::IsItemDeactivatedAfterEdit() || !show.typed) return;
    take(*show.typed);
    show.typed.reset();
}

void key_fields(PublishModel& show) {
    const auto selected = show.editor.selected();
    if (!selected) return;
    const KeyFrame key = show.editor.path().keys[*selected];
    ImGui::PushID(static_cast<int>(*selected));
    number_field(show, "time, s", key.time, [&](double time) { show.take(show.editor.set_time(time)); });
    number_field(show, "degrees of view", key.camera.vertical_fov * kDegrees,
                 [&](double fov) { show.take(show.editor.set_fov(fov / kDegrees)); });
    ImGui::PopID();
}

void preview(PublishModel& show) {
    const bool any = !show.editor.empty();
    if (button(show.playing ? "Stop" : "Play", any)) show.play();
    ImGui::SameLine();
    ImGui::BeginDisabled(!any);
    const double first = any ? show.editor.path().start() : 0,
                 last = any ? show.editor.path().keys.back().time : 0;
    show.time = std::clamp(show.time, first, last);
    if (ImGui::SliderScalar("##time", ImGuiDataType_Double, &show.time, &first, &last, "%.2f s")) {
        show.playing = false;
        show.sought = true;
    }
    ImGui::EndDisabled();
}

void files(PublishModel& show) {
    const bool any = !show.editor.empty();
    ImGui::InputText("path's file", &show.path_file);
    if (button("Save", any)) show.commands.push(SavePath{});
    ImGui::SameLine();
    if (button("Load", true)) show.commands.push(LoadPath{});
    ImGui::Separator();
    number_field(show, "frames a second", show.editor.path().frames_per_second,
                 [&](double rate) { show.take(show.editor.set_frames_per_second(rate)); });
    size_fields("size of frames", show.flight_width, show.flight_height);
    ImGui::InputText("PNG folder", &show.frames_folder);
    ImGui::InputText("video's file", &show.video_file);
    if (!render_progress(show)) return;
    if (button("Render frames", any)) show.commands.push(RenderFrames{});
    ImGui::SameLine();
    if (button("Render video", any)) show.commands.push(RenderVideo{});
}

}  // namespace

void draw_flythrough_panel(const Publishing& model) {
    PublishModel& show = model.publish;
    key_buttons(model);
    key_list(show);
    key_fields(show);
    preview(show);
    files(show);
}

}  // namespace lucarne::viewer
