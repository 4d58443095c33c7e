#include <algorithm>
#include <numbers>

#include <imgui.h>

#include "viewer/actions.h"
#include "viewer/panels/panels.h"

namespace lucarne::viewer {
namespace {

bool drag_point(const char* label, glm::dvec3& point, double scene_size) {
    double values[3] = {point.x, point.y, point.z};
    if (!ImGui::DragScalarN(label, ImGuiDataType_Double, values, 3, static_cast<float>(scene_size / 1000),
                            nullptr, nullptr, "%.2f"))
        return false;
    point = {values[0], values[1], values[2]};
    return true;
}

bool edit_spot(gi::SceneSpot& light, double scene_size) {
    bool changed = drag_point("position", light.position, scene_size);
    changed |= drag_point("aims at", light.target, scene_size);
    float degrees = static_cast<float>(light.angle * 180 / std::numbers::pi);
    if (ImGui::SliderFloat("cone", &degrees, 1, 170, "%.0f degrees", ImGuiSliderFlags_AlwaysClamp)) {
        light.angle = degrees * std::numbers::pi / 180;
        changed = true;
    }
    float softness = static_cast<float>(light.softness);
    if (ImGui::SliderFloat("soft edge", &softness, 0, 1, "%.2f", ImGuiSliderFlags_AlwaysClamp)) {
        light.softness = softness;
        changed = true;
    }
    float strength = static_cast<float>(std::max({light.intensity.x, light.intensity.y, light.intensity.z}));
    float color[3] = {1, 1, 1};
    if (strength > 0)
        for (int i = 0; i < 3; ++i) color[i] = static_cast<float>(light.intensity[i]) / strength;
    bool dyed = ImGui::ColorEdit3("colour", color, ImGuiColorEditFlags_Float);
    dyed |= ImGui::DragFloat("W/sr", &strength, std::max(strength, 0.01f) / 100, 1e-3f, 1e9f, "%.4g",
                             ImGuiSliderFlags_AlwaysClamp);
    if (dyed) light.intensity = glm::dvec3(color[0], color[1], color[2]) * static_cast<double>(strength);
    return changed || dyed;
}

}  // namespace

void draw_light_panel(ViewModel& model) {
    const float font = ImGui::GetFontSize();
    ImGui::SetNextWindowPos(ImVec2(8, font * 19), ImGuiCond_FirstUseEver);
    ImGui::SetNextWindowSize(ImVec2(font * 22, 0), ImGuiCond_FirstUseEver);
    if (ImGui::Begin("Light")) {
        for (size_t i = 0; model.scene.lights.size() > 1 && i < model.scene.lights.size(); ++i) {
            const std::string label = std::to_string(i + 1) + " " + model.scene.lights[i].name;
            if (ImGui::RadioButton(label.c_str(), model.light == i)) model.light = i;
        }
        if (gi::SceneSpot* light = model.selected_light()) {
            if (edit_spot(*light, model.scene_size)) model.scene_changed();
            if (ImGui::Button("Put it where the camera is")) place_light_at_camera(model);
        } else {
            ImGui::TextUnformatted("The scene has no light.");
        }
    }
    ImGui::End();
}

}  // namespace lucarne::viewer
