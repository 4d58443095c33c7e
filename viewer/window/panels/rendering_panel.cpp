#include <algorithm>
#include <string>

#include <imgui.h>

#include "gi/post/false_colour.h"
#include "gi/registry.h"
#include "viewer/light/edits.h"
#include "viewer/window/panels/panels.h"

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

/// cd/m^2 that false colours span.
void luminance_range(ViewModel& model) {
    const double ev = model.picture ? model.picture->exposure_ev : 0;
    const gi::ValueRange shown = gi::luminance_range(model.scene.luminance, ev);
    bool automatic = !model.scene.luminance;
    if (ImGui::Checkbox("automatic range", &automatic)) {
        model.scene.luminance = automatic ? std::nullopt : std::optional(shown);
        model.shown_changed();
    }
    float ends[2] = {static_cast<float>(shown.low), static_cast<float>(shown.high)};
    if (!automatic &&
        ImGui::DragFloatRange2("cd/m2", &ends[0], &ends[1], ends[1] / 200, 1e-6f, 1e12f, "%.4g", "%.4g",
                               ImGuiSliderFlags_AlwaysClamp | ImGuiSliderFlags_Logarithmic)) {
        model.scene.luminance = gi::ValueRange{ends[0], std::max(ends[1], ends[0] * 1.01f)};
        model.shown_changed();
    }
}

void exposure(ViewModel& model) {
    bool automatic = !model.scene.exposure_ev;
    const float measured = model.picture ? static_cast<float>(model.picture->exposure_ev) : 0.0f;
    if (ImGui::Checkbox("automatic exposure", &automatic)) {
        model.scene.exposure_ev = automatic ? std::nullopt : std::optional<double>(measured);
        model.shown_changed();
    }
    float stops = static_cast<float>(model.scene.exposure_ev.value_or(measured));
    if (ImGui::SliderFloat("exposure", &stops, -12.0f, 12.0f, "%+.1f stops")) {
        model.scene.exposure_ev = stops;
        model.shown_changed();
    }
    const char* const curves[] = {"filmic", "Reinhard", "none", "false colours"};
    int curve = static_cast<int>(model.scene.tone_map);
    if (ImGui::Combo("tone map", &curve, curves, 4)) {
        model.scene.tone_map = static_cast<gi::ToneMap>(curve);
        model.shown_changed();
    }
    if (model.scene.tone_map == gi::ToneMap::false_colour) luminance_range(model);
}

void tell_cost(const char* text) {
    if (ImGui::IsItemHovered()) ImGui::SetTooltip("%s", text);
}

/// One of the powers of two from 2^least to 2^most.
bool choose_power(const char* label, uint32_t& value, int least, int most) {
    int power = least;
    while (power < most && (1u << power) < value) ++power;
    if (!ImGui::SliderInt(label, &power, least, most, std::to_string(1u << power).c_str(),
                          ImGuiSliderFlags_AlwaysClamp))
        return false;
    value = 1u << power;
    return true;
}

/// How much is computed, each with what it costs.
void effort(ViewModel& model) {
    if (!fold("Effort")) return;
    gi::EngineSettings& settings = model.settings;
    int bounces = static_cast<int>(settings.bounces);
    if (ImGui::SliderInt("bounces", &bounces, 0, 8, "%d", ImGuiSliderFlags_AlwaysClamp))
        settings.bounces = static_cast<uint32_t>(bounces);
    tell_cost(
        "vpl: the lights are shared out among the bounces, so more cost little and are coarser;\n"
        "reference: time grows with them");
    int only = settings.only_bounce;
    if (ImGui::SliderInt("only bounce", &only, -1, 8, only < 0 ? "all" : "%d", ImGuiSliderFlags_AlwaysClamp))
        settings.only_bounce = only;
    if (model.engine == "vpl") {
        choose_power("VPLs", settings.vpls, 4, 12);
        tell_cost("virtual point lights: time and the shadow maps' memory grow with them");
        choose_power("interleaving", settings.interleave, 0, 2);
        tell_cost(
            "pixels along a side that share out the lights: 4 is up to 16 times faster than 1,\n"
            "at the price of blurred detail in indirect light");
        choose_power("shadow atlas", settings.atlas, 8, 13);
        tell_cost("texels along a side: twice as many cost four times the memory, and make finer shadows");
    }
    if (model.engine == "vpl" || model.engine == "direct") {
        choose_power("light resolution", settings.light_resolution, 6, 12);
        tell_cost(
            "texels along a side of each light's view: twice as many cost up to four times the time,\n"
            "and make sharper shadow edges");
    }
    if (model.engine == "reference") {
        choose_power("paths a pixel", settings.samples, 0, 10);
        tell_cost("of a picture: four times as many take four times as long and halve the noise");
    }
    float scale = static_cast<float>(100 * model.resolution_scale);
    if (ImGui::SliderFloat("resolution", &scale, 100 * gi::kLeastPictureScale, 100, "%.0f %%",
                           ImGuiSliderFlags_AlwaysClamp))
        model.resolution_scale = std::clamp(static_cast<double>(scale) / 100, gi::kLeastPictureScale, 1.0);
    tell_cost(
        "of the window's width and height that pictures are made at, and scaled up from:\n"
        "half takes a quarter of the pixels' time, and blurs");
    ImGui::TextDisabled("picture scale %.2f while moving", model.scale);
    tell_cost("while something moves, slow pictures get smaller; at rest they are made in full");
}

void albedo(ViewModel& model) {
    if (!fold("Albedo")) return;
    gi::Albedo& albedo = model.scene.albedo;
    float scale = static_cast<float>(albedo.scale), flatten = static_cast<float>(albedo.flatten);
    if (ImGui::SliderFloat("scale", &scale, 0, 3, "%.2f")) {
        albedo.scale = std::clamp(static_cast<double>(scale), 0.0, 10.0);
        model.scene_changed();
    }
    tell_cost("of what the points' colours reflect, which stays within 0 to .95; costs nothing");
    ImGui::SliderFloat("flatten", &flatten, 0, 1, "%.2f", ImGuiSliderFlags_AlwaysClamp);
    if (flatten != static_cast<float>(albedo.flatten)) {
        albedo.flatten = flatten;
        model.scene_changed();
    }
    tell_cost(
        "share of the light that the scan was taken in to be divided out: luminance is evened out over\n"
        "a 48th of the scan's length. All points are sent to the device again");
}

void comparison(ViewModel& model) {
    if (!fold("Compare")) return;
    auto& comparison = model.scene.comparison;
    if (ImGui::BeginCombo("with", comparison ? comparison->engine.c_str() : "nothing")) {
        if (ImGui::Selectable("nothing", !comparison)) compare_with(model, "");
        for (const auto& entry : gi::engines()) {
            const std::string name(entry.info.name);
            if (ImGui::Selectable(name.c_str(), comparison && comparison->engine == name))
                compare_with(model, name);
        }
        ImGui::EndCombo();
    }
    tell_cost("both engines light every picture: the times add up");
    if (!comparison) return;
    const char* const shows[] = {"side by side", "signed difference", "absolute difference"};
    int show = static_cast<int>(comparison->show);
    if (ImGui::Combo("as", &show, shows, 3)) {
        comparison->show = static_cast<gi::Comparison::Show>(show);
        model.shown_changed();
    }
    float range = static_cast<float>(comparison->range);
    if (show != 0 && ImGui::SliderFloat("range", &range, 0.01f, 10, "%.3g", ImGuiSliderFlags_Logarithmic)) {
        comparison->range = std::max(range, 1e-6f);
        model.shown_changed();
    }
}

}  // namespace

void draw_rendering_panel(ViewModel& model) {
    engine_choice(model);
    preset_choice(model);
    effort(model);
    exposure(model);
    albedo(model);
    comparison(model);
}

}  // namespace lucarne::viewer
