#include <array>

#include <imgui.h>

#include "viewer/ui/widgets.h"
#include "viewer/window/panels/panels.h"

namespace lucarne::viewer {
namespace {

constexpr std::array kAxes = {"right", "up", "forward", "nose up", "nose left", "right side down"};

void draw_status(const ControllerModel& controller) {
    using Kind = io::ControllerStatus::Kind;
    switch (controller.status.kind) {
        case Kind::none:
            ImGui::TextUnformatted("none is plugged in");
            break;
        case Kind::connected:
            ImGui::TextUnformatted(controller.status.name.c_str());
            break;
        case Kind::refused:
            ImGui::TextWrapped("%s: %s", controller.status.name.c_str(), controller.status.message.c_str());
            break;
    }
}

void draw_axis(io::SixDofMapping& mapping, size_t axis) {
    ImGui::PushID(static_cast<int>(axis));
    int from = mapping.from[axis];
    const LeftLabel label(kAxes[axis]);
    ImGui::SetNextItemWidth(ImGui::GetFontSize() * 6);
    if (ImGui::Combo("##from", &from, kAxes.data(), static_cast<int>(kAxes.size())))
        mapping.from[axis] = static_cast<uint8_t>(from);
    ImGui::SameLine();
    auto scale = static_cast<float>(mapping.scale[axis]);
    if (ImGui::SliderFloat(label, &scale, -3, 3, "%.2f times", ImGuiSliderFlags_AlwaysClamp))
        mapping.scale[axis] = scale;
    ImGui::PopID();
}

}  // namespace

void draw_controller_panel(ViewModel& model) {
    ControllerModel& controller = model.controller;
    io::SixDofMapping& mapping = model.settings.controller;
    draw_status(controller);
    ImGui::Separator();
    int hold = controller.holds_object ? 1 : 0;
    ImGui::RadioButton("The cap is the camera", &hold, 0);
    ImGui::SameLine();
    ImGui::RadioButton("The scan", &hold, 1);
    controller.holds_object = hold == 1;
    auto sensitivity = static_cast<float>(mapping.sensitivity),
         dead = static_cast<float>(100 * mapping.dead_zone);
    if (ImGui::SliderFloat(LeftLabel("Sensitivity"), &sensitivity, 0.05f, 10, "%.2f",
                           ImGuiSliderFlags_Logarithmic | ImGuiSliderFlags_AlwaysClamp))
        mapping.sensitivity = sensitivity;
    if (ImGui::SliderFloat(LeftLabel("Dead zone"), &dead, 0, 50, "%.0f %%", ImGuiSliderFlags_AlwaysClamp))
        mapping.dead_zone = dead / 100;
    ImGui::TextUnformatted("What moves the view, by which axis of the device:");
    for (size_t axis = 0; axis < kAxes.size(); ++axis) draw_axis(mapping, axis);
    if (ImGui::Button("As it came")) mapping = {};
}

}  // namespace lucarne::viewer
