// The panel of a flythrough's key frames, preview, files and rendering.
#include <algorithm>
#include <numbers>
#include <string>

#include <fmt/format.h>
#include <imgui.h>
#include <imgui_stdlib.h>

#include "viewer/publish/publishing.h"
#include "viewer/publish/render_progress.h"
#include "viewer/ui/widgets.h"

namespace lucarne::viewer {
namespace {

constexpr double kDegrees = 180 / std::numbers::pi;

bool button(const char* label, bool enabled) {
    ImGui::BeginDisabled(!enabled);
    const bool pressed = ImGui::Button(label);
    ImGui::EndDisabled();
    return pressed;
}

void key_list(PublishModel& publish) {
    if (!ImGui::BeginListBox("##keys", ImVec2(-1, ImGui::GetTextLineHeightWithSpacing() * 6))) return;
    const auto& keys = publish.editor.path().keys;
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
            if (ImGui::Selectable(text.c_str(), publish.editor.selected() == i)) publish.go_to_key(i);
            ImGui::PopID();
        }
    ImGui::EndListBox();
}

void key_buttons(const Publishing& model) {
    PublishModel& publish = model.publish;
    const bool one = publish.editor.selected().has_value();
    if (button("Add", model.view.picture != nullptr)) publish.add_key(model.view.rig.camera());
    ImGui::SameLine();
    if (button("Replace", one)) publish.take(publish.editor.replace(model.view.rig.camera()));
    ImGui::SameLine();
    if (button("Delete", one)) publish.take(publish.editor.remove());
    if (button("Earlier", one)) publish.take(publish.editor.move(-1));
    ImGui::SameLine();
    if (button("Later", one)) publish.take(publish.editor.move(1));
    ImGui::SameLine();
    ImGui::Checkbox("Draw the path", &publish.draw_path);
}

/// A number field whose value is passed to `take` once the user leaves the field, so that a half-typed number
/// is no error. ImGui reports "changed" in every frame in which the text differs from `value`; the last such
/// number counts, unless the user restored the old one.
template <class Take>
void number_field(PublishModel& publish, const char* label, double value, const Take& take) {
    if (ImGui::InputDouble(LeftLabel(label), &value, 0, 0, "%.6g"))
        publish.typed = value;
    else if (ImGui::IsItemActive() || ImGui::IsKeyPressed(ImGui::GetKeyIndex(ImGuiKey_Escape)))
        publish.typed.reset();
    if (!ImGui::IsItemDeactivatedAfterEdit() || !publish.typed) return;
    take(*publish.typed);
    publish.typed.reset();
}

void key_fields(PublishModel& publish) {
    const auto selected = publish.editor.selected();
    if (!selected) return;
    const KeyFrame key = publish.editor.path().keys[*selected];
    ImGui::PushID(static_cast<int>(*selected));
    number_field(publish, "Time, s", key.time,
                 [&](double time) { publish.take(publish.editor.set_time(time)); });
    number_field(publish, "Field of view", key.camera.vertical_fov * kDegrees,
                 [&](double fov) { publish.take(publish.editor.set_fov(fov / kDegrees)); });
    ImGui::PopID();
}

void preview(PublishModel& publish) {
    const bool any = !publish.editor.empty();
    if (button(publish.playing ? "Stop" : "Play", any)) publish.play();
    ImGui::SameLine();
    ImGui::BeginDisabled(!any);
    const double first = any ? publish.editor.path().start() : 0,
                 last = any ? publish.editor.path().keys.back().time : 0;
    publish.time = std::clamp(publish.time, first, last);
    if (ImGui::SliderScalar("##time", ImGuiDataType_Double, &publish.time, &first, &last, "%.2f s")) {
        publish.playing = false;
        publish.sought = true;
    }
    ImGui::EndDisabled();
}

void files(PublishModel& publish) {
    const bool any = !publish.editor.empty();
    ImGui::InputText(LeftLabel("Path's file"), &publish.path_file);
    if (button("Save", any)) publish.commands.push(SavePath{});
    ImGui::SameLine();
    if (button("Load", true)) publish.commands.push(LoadPath{});
    ImGui::Separator();
    number_field(publish, "Frames a second", publish.editor.path().frames_per_second,
                 [&](double rate) { publish.take(publish.editor.set_frames_per_second(rate)); });
    size_fields("Size of frames", publish.flight_width, publish.flight_height);
    ImGui::InputText(LeftLabel("PNG folder"), &publish.frames_folder);
    ImGui::InputText(LeftLabel("Video's file"), &publish.video_file);
    if (!render_progress(publish)) return;
    if (button("Render frames", any)) publish.commands.push(RenderFrames{});
    ImGui::SameLine();
    if (button("Render video", any)) publish.commands.push(RenderVideo{});
}

}  // namespace

void draw_flythrough_panel(const Publishing& model) {
    PublishModel& publish = model.publish;
    key_buttons(model);
    key_list(publish);
    key_fields(publish);
    preview(publish);
    files(publish);
}

}  // namespace lucarne::viewer
