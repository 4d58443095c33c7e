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

bool edit_angle(const char* label, double& radians, float least, float most) {
    float degrees = static_cast<float>(radians * 180 / std::numbers::pi);
    if (!ImGui::SliderFloat(label, &degrees, least, most, "%.1f degrees", ImGuiSliderFlags_AlwaysClamp))
        return false;
    radians = degrees * std::numbers::pi / 180;
    return true;
}

bool edit_length(const char* label, double& length, double scene_size) {
    const double least = 1e-6;
    return ImGui::DragScalar(label, ImGuiDataType_Double, &length, static_cast<float>(scene_size / 1000),
                             &least, nullptr, "%.3f", ImGuiSliderFlags_AlwaysClamp);
}

/// Colour and strength in the kind's unit.
bool edit_strength(gi::SceneLight& light) {
    static constexpr const char* kUnits[] = {"W/sr", "W/sr", "W/m^2", "W/(sr m^2)", "W/(sr m^2)"};
    float strength = static_cast<float>(std::max({light.strength.x, light.strength.y, light.strength.z}));
    float color[3] = {1, 1, 1};
    if (strength > 0)
        for (int i = 0; i < 3; ++i) color[i] = static_cast<float>(light.strength[i]) / strength;
    bool dyed = ImGui::ColorEdit3("colour", color, ImGuiColorEditFlags_Float);
    dyed |=
        ImGui::DragFloat(kUnits[static_cast<size_t>(light.kind)], &strength, std::max(strength, 0.01f) / 100,
                         1e-3f, 1e9f, "%.4g", ImGuiSliderFlags_AlwaysClamp);
    if (dyed) light.strength = glm::dvec3(color[0], color[1], color[2]) * static_cast<double>(strength);
    return dyed;
}

bool edit_light(gi::SceneLight& light, double scene_size) {
    using gi::LightKind;
    bool changed = drag_point("position", light.position, scene_size);
    if (light.kind != LightKind::point) changed |= drag_point("aims at", light.target, scene_size);
    switch (light.kind) {
        case LightKind::spot: {
            changed |= edit_angle("cone", light.angle, 1, 170);
            float softness = static_cast<float>(light.softness);
            if (ImGui::SliderFloat("soft edge", &softness, 0, 1, "%.2f", ImGuiSliderFlags_AlwaysClamp)) {
                light.softness = softness;
                changed = true;
            }
            break;
        }
        case LightKind::directional:
            changed |= edit_angle("angular radius", light.angular_radius, 0, 90);
            break;
        case LightKind::rectangle:
            changed |= edit_length("width", light.width, scene_size);
            changed |= edit_length("height", light.height, scene_size);
            break;
        case LightKind::disc:
            changed |= edit_length("radius", light.radius, scene_size);
            break;
        case LightKind::point:
            break;
    }
    return edit_strength(light) || changed;
}

}  // namespace

void draw_light_panel(ViewModel& model) {
    const float font = ImGui::GetFontSize();
    ImGui::SetNextWindowPos(ImVec2(8, font * 21), ImGuiCond_FirstUseEver);
    ImGui::SetNextWindowSize(ImVec2(font * 22, 0), ImGuiCond_FirstUseEver);
    if (ImGui::Begin("Light")) {
        for (size_t i = 0; model.scene.lights.size() > 1 && i < model.scene.lights.size(); ++i) {
            const std::string label = std::to_string(i + 1) + " " + model.scene.lights[i].name;
            if (ImGui::RadioButton(label.c_str(), model.light == i)) model.light = i;
        }
        if (gi::SceneLight* light = model.selected_light()) {
            if (edit_light(*light, model.scene_size)) model.scene_changed();
            if (ImGui::Button("Put it where the camera is")) place_light_at_camera(model);
        } else {
            ImGui::TextUnformatted("The scene has no light.");
        }
    }
    ImGui::End();
}

}  // namespace lucarne::viewer
