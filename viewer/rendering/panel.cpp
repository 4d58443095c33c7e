#include <algorithm>
#include <cmath>
#include <string>

#include <fmt/format.h>
#include <imgui.h>

#include "gi/post/false_colour.h"
#include "gi/registry.h"
#include "gi/scene/photometry.h"
#include "viewer/rendering/rendering.h"
#include "viewer/ui/widgets.h"

namespace lucarne::viewer {
namespace {

/// Draws an engine's entry of a list: greyed out with the reason if it cannot run here. Returns whether it
/// was clicked.
bool engine_entry(const gi::EngineInfo& engine, bool chosen) {
    const auto runs = gi::can_run(engine);
    if (!runs) ImGui::BeginDisabled();
    const bool clicked = ImGui::Selectable(std::string(engine.label).c_str(), chosen);
    if (!runs) ImGui::EndDisabled();
    if (ImGui::IsItemHovered(ImGuiHoveredFlags_AllowWhenDisabled)) {
        const std::string text =
            runs ? fmt::format("{}: {}", engine.name, engine.description) : runs.error().line();
        ImGui::SetTooltip("%s", text.c_str());
    }
    return clicked;
}

void engine_choice(const Rendering& model) {
    if (!ImGui::BeginCombo(LeftLabel("Engine"), gi::label_of(model.view.method.engine).c_str())) return;
    for (const auto& entry : gi::engines())
        if (engine_entry(entry.info, entry.info.name == model.view.method.engine))
            model.view.method.engine = entry.info.name;
    ImGui::EndCombo();
}

void preset_choice(const Rendering& model) {
    if (!ImGui::BeginCombo(LeftLabel("Preset"), model.view.preset.c_str())) return;
    for (const Preset& preset : presets()) {
        const std::string name(preset.name), description(preset.description);
        if (ImGui::Selectable(name.c_str(), name == model.view.preset))
            if (const auto chosen = model.view.choose_preset(name); !chosen)
                model.view.message = chosen.error().line();
        if (ImGui::IsItemHovered()) ImGui::SetTooltip("%s", description.c_str());
    }
    ImGui::EndCombo();
}

/// Edits the range of false colours, cd/m^2 or lx.
void luminance_range(const Rendering& model) {
    const double ev = model.view.picture ? model.view.picture->exposure_ev : 0;
    const gi::ToneMap map = model.view.scene.tone_map;
    const gi::ValueRange shown = gi::false_colour_range(map, model.view.scene.luminance, ev);
    const char* const unit = map == gi::ToneMap::illuminance ? "%.4g lx" : "%.4g cd/m2";
    bool automatic = !model.view.scene.luminance;
    if (ImGui::Checkbox("Automatic range", &automatic)) {
        model.view.scene.luminance = automatic ? std::nullopt : std::optional(shown);
        model.view.shown_changed();
    }
    float ends[2] = {static_cast<float>(shown.low), static_cast<float>(shown.high)};
    if (!automatic &&
        ImGui::DragFloatRange2(LeftLabel("Range"), &ends[0], &ends[1], ends[1] / 200, 1e-6f, 1e12f, unit,
                               unit, ImGuiSliderFlags_AlwaysClamp | ImGuiSliderFlags_Logarithmic)) {
        model.view.scene.luminance = gi::ValueRange{ends[0], std::max(ends[1], ends[0] * 1.01f)};
        model.view.shown_changed();
    }
}

/// Edits a colour of light by the temperature of the nearest black body. Returns whether it has changed.
bool temperature(const char* label, glm::dvec3& white) {
    const glm::dvec3 daylight = gi::black_body_colour(gi::kDaylight);
    float kelvin = static_cast<float>(gi::black_body_temperature(white * daylight));
    if (!ImGui::SliderFloat(LeftLabel(label), &kelvin, 2000, 12000, "%.0f K", ImGuiSliderFlags_AlwaysClamp))
        return false;
    white = gi::black_body_colour(kelvin) / daylight;
    return true;
}

/// Edits which light is shown as white.
void white_balance(View& view) {
    if (temperature("White balance", view.scene.white)) view.shown_changed();
    if (ImGui::IsItemHovered())
        ImGui::SetTooltip("Light of this colour is shown as white. 6500 K: colours are shown as they are.");
}

void exposure(const Rendering& model) {
    bool automatic = !model.view.scene.exposure_ev;
    const float measured = model.view.picture ? static_cast<float>(model.view.picture->exposure_ev) : 0.0f;
    if (ImGui::Checkbox("Automatic exposure", &automatic)) {
        model.view.scene.exposure_ev = automatic ? std::nullopt : std::optional<double>(measured);
        model.view.shown_changed();
    }
    float stops = static_cast<float>(model.view.scene.exposure_ev.value_or(measured));
    if (ImGui::SliderFloat(LeftLabel("Exposure"), &stops, -12.0f, 12.0f, "%+.1f stops")) {
        model.view.scene.exposure_ev = stops;
        model.view.shown_changed();
    }
    white_balance(model.view);
    const char* const curves[] = {"Filmic", "Reinhard", "None", "False colours: luminance",
                                  "False colours: illuminance"};
    int curve = static_cast<int>(model.view.scene.tone_map);
    if (ImGui::Combo(LeftLabel("Tone map"), &curve, curves, 5)) {
        model.view.scene.tone_map = static_cast<gi::ToneMap>(curve);
        model.view.shown_changed();
    }
    if (gi::shows_figures(model.view.scene.tone_map)) luminance_range(model);
}

void tell_cost(const char* text) {
    if (ImGui::IsItemHovered()) ImGui::SetTooltip("%s", text);
}

/// Draws a slider over the powers of two within the option's range. Returns true if the user moved it.
bool choose_power(const char* label, const gi::SliderRange& slider, int64_t& value) {
    const int least = static_cast<int>(std::log2(slider.least)),
              most = static_cast<int>(std::log2(slider.most));
    int power = least;
    while (power < most && (int64_t{1} << power) < value) ++power;
    if (!ImGui::SliderInt(LeftLabel(label), &power, least, most, std::to_string(int64_t{1} << power).c_str(),
                          ImGuiSliderFlags_AlwaysClamp))
        return false;
    value = int64_t{1} << power;
    return true;
}

bool edit_integer(const gi::OptionInfo& option, const char* label, gi::OptionValue& value) {
    auto& whole = std::get<int64_t>(value);
    if (option.slider.logarithmic) return choose_power(label, option.slider, whole);
    int now = static_cast<int>(whole);
    const bool unset = !option.unset.empty() && now < option.least;
    if (!ImGui::SliderInt(LeftLabel(label), &now, static_cast<int>(option.slider.least),
                          static_cast<int>(option.slider.most),
                          unset ? std::string(option.unset).c_str() : "%d", ImGuiSliderFlags_AlwaysClamp))
        return false;
    whole = now;
    return true;
}

bool edit_number(const gi::OptionInfo& option, const char* label, gi::OptionValue& value) {
    auto now = static_cast<float>(std::get<double>(value));
    const auto least = static_cast<float>(option.slider.least), most = static_cast<float>(option.slider.most);
    const ImGuiSliderFlags scale =
        option.slider.logarithmic ? ImGuiSliderFlags_Logarithmic : ImGuiSliderFlags_None;
    if (!ImGui::SliderFloat(LeftLabel(label), &now, least, most, "%.3g",
                            ImGuiSliderFlags_AlwaysClamp | scale))
        return false;
    value = static_cast<double>(now);
    return true;
}

bool edit_choice(const gi::OptionInfo& option, const char* label, gi::OptionValue& value) {
    auto& chosen = std::get<int64_t>(value);
    const std::string shown = gi::option_text(option, value);
    if (!ImGui::BeginCombo(LeftLabel(label), shown.c_str())) return false;
    bool changed = false;
    for (size_t i = 0; i < option.choices.size(); ++i) {
        if (!ImGui::Selectable(std::string(option.choices[i]).c_str(), chosen == static_cast<int64_t>(i)))
            continue;
        chosen = static_cast<int64_t>(i);
        changed = true;
    }
    ImGui::EndCombo();
    return changed;
}

bool edit_colour(const char* label, gi::OptionValue& value) {
    auto& colour = std::get<glm::dvec3>(value);
    float shown[3] = {static_cast<float>(colour.x), static_cast<float>(colour.y),
                      static_cast<float>(colour.z)};
    if (!ImGui::ColorEdit3(LeftLabel(label), shown, ImGuiColorEditFlags_Float)) return false;
    colour = glm::clamp(glm::dvec3(shown[0], shown[1], shown[2]), 0.0, 1.0);
    return true;
}

/// Draws the option's control. Returns true if the user changed `value`.
bool edit_option(const gi::OptionInfo& option, gi::OptionValue& value) {
    const std::string label(option.label);
    switch (option.kind) {
        case gi::OptionKind::flag:
            return ImGui::Checkbox(label.c_str(), &std::get<bool>(value));
        case gi::OptionKind::integer:
            return edit_integer(option, label.c_str(), value);
        case gi::OptionKind::number:
            return edit_number(option, label.c_str(), value);
        case gi::OptionKind::choice:
            return edit_choice(option, label.c_str(), value);
        case gi::OptionKind::colour:
            return edit_colour(label.c_str(), value);
    }
    return false;
}

/// Draws the engine's options with their costs, and the size of pictures.
void effort(const Rendering& model) {
    if (!fold("Effort")) return;
    if (const auto engine = gi::find_engine(model.view.method.engine))
        for (const gi::OptionInfo* option : (*engine)->info.options) {
            if (!option->in_window()) continue;
            gi::OptionValue value = model.view.method.settings.get(*option);
            if (edit_option(*option, value)) model.view.method.settings.set(*option, value);
            if (!option->cost.empty()) tell_cost(std::string(option->cost).c_str());
        }
    float scale = static_cast<float>(100 * model.view.resolution_scale);
    if (ImGui::SliderFloat(LeftLabel("Resolution"), &scale, 100 * gi::kLeastPictureScale, 100, "%.0f %%",
                           ImGuiSliderFlags_AlwaysClamp))
        model.view.resolution_scale =
            std::clamp(static_cast<double>(scale) / 100, gi::kLeastPictureScale, 1.0);
    tell_cost(
        "of the window's width and height that pictures are made at, and scaled up from:\n"
        "half takes a quarter of the pixels' time, and blurs");
    ImGui::TextDisabled("picture scale %.2f while moving", model.view.scale);
    tell_cost("while something moves, slow pictures get smaller; at rest they are made in full");
}

void albedo(const Rendering& model) {
    if (!fold("Albedo")) return;
    gi::Albedo& albedo = model.view.scene.albedo;
    float scale = static_cast<float>(albedo.scale), flatten = static_cast<float>(albedo.flatten);
    if (ImGui::SliderFloat(LeftLabel("Scale"), &scale, 0, 3, "%.2f")) {
        albedo.scale = std::clamp(static_cast<double>(scale), 0.0, 10.0);
        model.view.scene_changed();
    }
    tell_cost("of what the points' colours reflect, which stays within 0 to .95; costs nothing");
    ImGui::SliderFloat(LeftLabel("Flatten"), &flatten, 0, 1, "%.2f", ImGuiSliderFlags_AlwaysClamp);
    if (flatten != static_cast<float>(albedo.flatten)) {
        albedo.flatten = flatten;
        model.view.scene_changed();
    }
    tell_cost(
        "share of the light that the scan was taken in to be divided out: luminance is evened out over\n"
        "a 48th of the scan's length. All points are sent to the device again");
    if (temperature("Light of the scan", albedo.white)) model.view.scene_changed();
    tell_cost(
        "colour of the light in which the points were photographed, which is divided out of their colours.\n"
        "All points are sent to the device again");
    if (ImGui::Checkbox("Balance colours", &albedo.balance)) model.view.scene_changed();
    tell_cost(
        "grains of light and dark points are evened out, gains that the conversion found make stations of\n"
        "different exposure agree, and points that were never photographed get the colour around them. All "
        "points are sent to the device again");
}

void comparison(const Rendering& model) {
    if (!fold("Compare")) return;
    auto& comparison = model.view.scene.comparison;
    if (ImGui::BeginCombo(LeftLabel("With"),
                          comparison ? gi::label_of(comparison->engine).c_str() : "Nothing")) {
        if (ImGui::Selectable("Nothing", !comparison)) compare_with(model.view, "");
        for (const auto& entry : gi::engines())
            if (engine_entry(entry.info, comparison && comparison->engine == entry.info.name))
                compare_with(model.view, std::string(entry.info.name));
        ImGui::EndCombo();
    }
    tell_cost("both engines light every picture: the times add up");
    if (!comparison) return;
    const char* const shows[] = {"Side by side", "Signed difference", "Absolute difference"};
    int show = static_cast<int>(comparison->show);
    if (ImGui::Combo(LeftLabel("As"), &show, shows, 3)) {
        comparison->show = static_cast<gi::Comparison::Show>(show);
        model.view.shown_changed();
    }
    float range = static_cast<float>(comparison->range);
    if (show != 0 &&
        ImGui::SliderFloat(LeftLabel("Range"), &range, 0.01f, 10, "%.3g", ImGuiSliderFlags_Logarithmic)) {
        comparison->range = std::max(range, 1e-6f);
        model.view.shown_changed();
    }
}

}  // namespace

void draw_rendering_panel(const Rendering& model) {
    engine_choice(model);
    preset_choice(model);
    effort(model);
    exposure(model);
    albedo(model);
    comparison(model);
}

}  // namespace lucarne::viewer
