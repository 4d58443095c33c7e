#include <string>

#include <imgui.h>

#include "gi/registry.h"
#include "viewer/panels/panels.h"

namespace lucarne::viewer {
namespace {

void engine_choice(ViewModel& model) {
    if (!ImGui::BeginCombo("engine", model.engine.c_str())) return;
    for (const auto& entry : gi::engines()) {
        const std::string name(entry.info.name), description(entry.info.description);
        if (ImGui::Selectable(name.c_str(), name == model.engine)) model.engine = name;
        if (ImGui::IsItemHovered()) ImGui::SetTooltip("%s", description.c_str());
    }
    ImGui::EndCombo();
}

void preset_choice(ViewModel& model) {
    if (!ImGui::BeginCombo("preset", model.preset.c_str())) return;
    for (const Preset& preset : presets()) {
        const std::string name(preset.name), description(preset.description);
        if (ImGui::Selectable(name.c_str(), name == model.preset))
            if (const auto chosen = model.choose_preset(name); !chosen) model.message = chosen.error().line();
        if (ImGui::IsItemHovered()) ImGui::SetTooltip("%s", description.c_str());
    }
    ImGui::EndCombo();
}

void exposure(ViewModel& model) {
    bool automatic = !model.scene.exposure_ev;
    const float measured = model.picture ? static_cast<float>(model.picture->exposure_ev) : 0.0f;
    if (ImGui::Checkbox("automatic exposure", &automatic)) {
        model.scene.exposure_ev = automatic ? std::nullopt : std::optional<double>(measured);
        model.scene_changed();
    }
    float stops = static_cast<float>(model.scene.exposure_ev.value_or(measured));
    if (ImGui::SliderFloat("exposure", &stops, -12.0f, 12.0f, "%+.1f stops")) {
        model.scene.exposure_ev = stops;
        model.scene_changed();
    }
    const char* const curves[] = {"filmic", "Reinhard", "none"};
    int curve = static_cast<int>(model.scene.tone_map);
    if (ImGui::Combo("tone map", &curve, curves, 3)) {
        model.scene.tone_map = static_cast<gi::ToneMap>(curve);
        model.scene_changed();
    }
}

}  // namespace

void draw_settings_panel(ViewModel& model) {
    const float width = ImGui::GetFontSize() * 22;
    const float top = ImGui::GetFrameHeight() + 8;  // below the menu bar
    ImGui::SetNextWindowPos(ImVec2(8, top), ImGuiCond_FirstUseEver);
    ImGui::SetNextWindowSize(ImVec2(width, 0), ImGuiCond_FirstUseEver);
    if (ImGui::Begin("Picture")) {
        engine_choice(model);
        preset_choice(model);
        int bounces = static_cast<int>(model.settings.bounces);
        if (ImGui::SliderInt("bounces", &bounces, 0, 8, "%d", ImGuiSliderFlags_AlwaysClamp))
            model.settings.bounces = static_cast<uint32_t>(bounces);
        int only = model.settings.only_bounce;
        if (ImGui::SliderInt("only bounce", &only, -1, 8, only < 0 ? "all" : "%d",
                             ImGuiSliderFlags_AlwaysClamp))
            model.settings.only_bounce = only;
        exposure(model);
        if (ImGui::Button("Save picture")) model.save_picture = true;
        ImGui::TextDisabled("F1: all keys");
    }
    ImGui::End();
}

}  // namespace lucarne::viewer
