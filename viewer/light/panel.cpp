#include <algorithm>
#include <numbers>

#include <imgui.h>
#include <imgui_stdlib.h>

#include "gi/scene/photometry.h"
#include "gi/shared/surfel_code.h"
#include "viewer/light/edits.h"
#include "viewer/light/lighting.h"
#include "viewer/light/preparing.h"
#include "viewer/ui/widgets.h"

namespace lucarne::viewer {
namespace {

bool drag_point(const char* label, glm::dvec3& point, double scene_size) {
    double values[3] = {point.x, point.y, point.z};
    if (!ImGui::DragScalarN(LeftLabel(label), ImGuiDataType_Double, values, 3,
                            static_cast<float>(scene_size / 1000), nullptr, nullptr, "%.2f"))
        return false;
    point = {values[0], values[1], values[2]};
    return true;
}

bool edit_angle(const char* label, double& radians, float least, float most) {
    float degrees = static_cast<float>(radians * 180 / std::numbers::pi);
    if (!ImGui::SliderFloat(LeftLabel(label), &degrees, least, most, "%.1f°", ImGuiSliderFlags_AlwaysClamp))
        return false;
    radians = degrees * std::numbers::pi / 180;
    return true;
}

bool edit_length(const char* label, double& length, double scene_size) {
    const double least = 1e-6;
    return ImGui::DragScalar(LeftLabel(label), ImGuiDataType_Double, &length,
                             static_cast<float>(scene_size / 1000), &least, nullptr, "%.3f",
                             ImGuiSliderFlags_AlwaysClamp);
}

/// Sets the colour and keeps the luminance.
void dye(gi::SceneLight& light, const glm::dvec3& colour) {
    const double now = gi::luminance(light.strength), then = gi::luminance(colour);
    if (then > 0) light.strength = colour * ((now > 0 ? now : 1.0) / then);
}

/// Edits the light's colour as the screen shows it, or by its temperature.
bool edit_colour(gi::SceneLight& light) {
    const double most = std::max({light.strength.x, light.strength.y, light.strength.z});
    float shown[3];
    for (int i = 0; i < 3; ++i)
        shown[i] = gi::linear_to_srgb(most > 0 ? static_cast<float>(light.strength[i] / most) : 1.0f);
    bool changed = false;
    if (ImGui::ColorEdit3(LeftLabel("Colour"), shown, ImGuiColorEditFlags_Float)) {
        const glm::dvec3 linear(gi::srgb_to_linear(shown[0]), gi::srgb_to_linear(shown[1]),
                                gi::srgb_to_linear(shown[2]));
        dye(light, linear);
        changed = true;
    }
    float kelvin = static_cast<float>(gi::black_body_temperature(light.strength));
    if (ImGui::SliderFloat(LeftLabel("Temperature"), &kelvin, gi::kCoolest, 12000, "%.0f K",
                           ImGuiSliderFlags_AlwaysClamp | ImGuiSliderFlags_Logarithmic)) {
        dye(light, gi::black_body_colour(kelvin));
        changed = true;
    }
    return changed;
}

/// Edits the strength: in the kind's radiometric unit for the strongest channel, or in photometric units.
bool edit_strength(const Lighting& model, gi::SceneLight& light) {
    static constexpr const char* kUnits[] = {"W/sr", "W/sr", "W/m2", "W/(sr m2)", "W/(sr m2)"};
    const bool sun = light.kind == gi::LightKind::directional;
    const double metres = model.view.picture ? model.view.picture->metres_per_unit : 1;
    bool& lumens = model.lights.lumens;
    const double most = std::max({light.strength.x, light.strength.y, light.strength.z});
    double value = lumens ? gi::luminous_flux(light, metres) : most;
    const double least = 1e-6, largest = 1e12;
    const char* unit = !lumens ? kUnits[static_cast<size_t>(light.kind)] : sun ? "lx" : "lm";
    const LeftLabel label("Strength");
    ImGui::SetNextItemWidth(-4.5f * ImGui::GetFontSize());  // leaves room for the unit
    bool changed = ImGui::DragScalar(label, ImGuiDataType_Double, &value,
                                     static_cast<float>(std::max(value, 0.01) / 100), &least, &largest,
                                     (std::string("%.4g ") + unit).c_str(), ImGuiSliderFlags_AlwaysClamp);
    if (changed && lumens) gi::set_luminous_flux(light, value, metres);
    if (changed && !lumens) light.strength = most > 0 ? light.strength * (value / most) : glm::dvec3(value);
    ImGui::SameLine();
    ImGui::Checkbox(sun ? "lx##unit" : "lm##unit", &lumens);
    if (ImGui::IsItemHovered())
        ImGui::SetTooltip(
            "179 lm a watt of white light in the visible band (Ward & Shakespeare 1998),\n"
            "colours weighted by Rec. 709's luminance");
    changed |= edit_colour(light);
    if (changed) light.daylight = false;
    return changed;
}

bool edit_shape(gi::SceneLight& light, double scene_size) {
    using gi::LightKind;
    bool changed = false;
    switch (light.kind) {
        case LightKind::spot: {
            changed |= edit_angle("Cone angle", light.angle, 1, 170);
            float softness = static_cast<float>(light.softness);
            if (ImGui::SliderFloat(LeftLabel("Edge softness"), &softness, 0, 1, "%.2f",
                                   ImGuiSliderFlags_AlwaysClamp)) {
                light.softness = softness;
                changed = true;
            }
            break;
        }
        case LightKind::directional:
            changed |= edit_angle("Angular radius", light.angular_radius, 0, 90);
            break;
        case LightKind::rectangle:
            changed |= edit_length("Width", light.width, scene_size);
            changed |= edit_length("Height", light.height, scene_size);
            break;
        case LightKind::disc:
            changed |= edit_length("Radius", light.radius, scene_size);
            break;
        case LightKind::point:
            break;
    }
    return changed;
}

bool edit_light(const Lighting& model, gi::SceneLight& light) {
    const bool sun = light.kind == gi::LightKind::directional;
    bool changed = edit_strength(model, light);
    if (sun)
        draw_sun(model);
    else if (ImGui::Button("Move to the camera"))
        place_light_at_camera(model);
    if (!fold("More")) return changed;
    if (ImGui::InputText(LeftLabel("Name"), &light.name)) model.view.shown_changed();
    if (!sun) {
        changed |= drag_point("Position", light.position, model.view.scene_size);
        if (light.kind != gi::LightKind::point)
            changed |= drag_point("Target", light.target, model.view.scene_size);
    }
    return edit_shape(light, model.view.scene_size) || changed;
}

void draw_list(const Lighting& model) {
    for (size_t i = 0; i < model.view.scene.lights.size(); ++i) {
        gi::SceneLight& light = model.view.scene.lights[i];
        ImGui::PushID(static_cast<int>(i));
        if (ImGui::Checkbox("##on", &light.on)) model.view.scene_changed();
        ImGui::SameLine();
        const std::string label = std::to_string(i + 1) + " " + light.name;
        if (ImGui::Selectable(label.c_str(), model.lights.selected == i)) model.lights.selected = i;
        ImGui::PopID();
    }
    if (model.view.scene.lights.empty()) ImGui::TextDisabled("The scene has no light.");
}

void draw_buttons(const Lighting& model) {
    static constexpr const char* kKinds[] = {"Spot", "Point", "Sun", "Rectangle", "Disc"};
    if (ImGui::Button("Add")) ImGui::OpenPopup("kinds");
    if (ImGui::BeginPopup("kinds")) {
        for (size_t kind = 0; kind < std::size(kKinds); ++kind)
            if (ImGui::Selectable(kKinds[kind])) add_light(model, static_cast<gi::LightKind>(kind));
        ImGui::EndPopup();
    }
    ImGui::SameLine();
    if (ImGui::Button("Copy")) duplicate_light(model);
    ImGui::SameLine();
    if (ImGui::Button("Delete")) remove_light(model);
    ImGui::SameLine();
    ImGui::Checkbox("Handles", &model.lights.show_handles);
}

}  // namespace

void draw_light_panel(const Lighting& model) {
    draw_list(model);
    draw_buttons(model);
    if (gi::SceneLight* light = model.selected_light()) {
        ImGui::Separator();
        if (edit_light(model, *light)) model.view.scene_changed();
    }
    draw_sky(model);
    draw_emitters(model);
    draw_preparing(model);
}

}  // namespace lucarne::viewer
