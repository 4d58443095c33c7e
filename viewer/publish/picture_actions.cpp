#include <algorithm>
#include <array>

#define GLFW_INCLUDE_NONE
#include <GLFW/glfw3.h>
#include <fmt/format.h>

#include "gi/bounce_options.h"
#include "gi/registry.h"
#include "viewer/light/edits.h"
#include "viewer/window/actions.h"

namespace lucarne::viewer {
namespace {

constexpr double kExposureStep = 0.5;  ///< stops
constexpr uint32_t kMostBounces = 8;

void next_engine(ViewModel& model) {
    const auto engines = gi::engines();
    const auto now =
        std::ranges::find(engines, model.engine, [](const auto& entry) { return entry.info.name; });
    const auto next = now == engines.end() || now + 1 == engines.end() ? engines.begin() : now + 1;
    model.engine = next->info.name;
    model.message = fmt::format("engine {}: {}", next->info.name, next->info.description);
}

void next_preset(ViewModel& model) {
    const auto all = presets();
    const auto now = std::ranges::find(all, model.preset, &Preset::name);
    const Preset& next = now == all.end() || now + 1 == all.end() ? all.front() : now[1];
    if (model.choose_preset(next.name))
        model.message = fmt::format("preset {}: {}", next.name, next.description);
}

void change_bounces(ViewModel& model, int by) {
    const auto bounces = static_cast<uint32_t>(
        std::clamp<int64_t>(int64_t{model.settings[gi::kBounces]} + by, 0, kMostBounces));
    model.settings.set(gi::kBounces, bounces);
    model.message = fmt::format("{} indirect bounce{}", bounces, bounces == 1 ? "" : "s");
}
void more_bounces(ViewModel& model) {
    change_bounces(model, 1);
}
void fewer_bounces(ViewModel& model) {
    change_bounces(model, -1);
}

void change_exposure(ViewModel& model, double stops) {
    const double now = model.scene.exposure_ev.value_or(model.picture ? model.picture->exposure_ev : 0.0);
    model.scene.exposure_ev = std::clamp(now + stops, -40.0, 40.0);
    model.shown_changed();
    model.message = fmt::format("exposure {:+.1f} stops", *model.scene.exposure_ev);
}
void brighter(ViewModel& model) {
    change_exposure(model, kExposureStep);
}
void darker(ViewModel& model) {
    change_exposure(model, -kExposureStep);
}
void automatic_exposure(ViewModel& model) {
    model.scene.exposure_ev.reset();
    model.shown_changed();
    model.message = "automatic exposure";
}

bool exposes_itself(const ViewModel& model) {
    return !model.scene.exposure_ev;
}

void next_tone_map(ViewModel& model) {
    const auto names = gi::tone_map_names();
    model.scene.tone_map =
        static_cast<gi::ToneMap>((static_cast<size_t>(model.scene.tone_map) + 1) % names.size());
    model.shown_changed();
    model.message = fmt::format("tone map {}", names[static_cast<size_t>(model.scene.tone_map)]);
}
bool compares(const ViewModel& model) {
    return model.scene.comparison.has_value();
}
void toggle_comparison(ViewModel& model) {
    // Compare with direct light alone, to show what indirect light adds.
    const auto& direct = gi::engine_with(&gi::EngineInfo::direct_only);
    const auto& other = model.engine == direct.name ? gi::default_engine() : direct;
    compare_with(model, compares(model) ? "" : std::string(other.name));
}
void next_comparison(ViewModel& model) {
    const auto names = gi::comparison_names();
    auto& show = model.scene.comparison->show;
    show = static_cast<gi::Comparison::Show>((static_cast<size_t>(show) + 1) % names.size());
    model.shown_changed();
    model.message = fmt::format("comparison: {}", names[static_cast<size_t>(show)]);
}

}  // namespace

Result<void> ViewModel::choose_preset(std::string_view name) {
    LUCARNE_ASSIGN(const Preset chosen, find_preset(name));
    const gi::EngineSettings before = settings;
    preset = chosen.name;
    settings = chosen.engine;
    budgets = chosen.budgets;
    for (const gi::OptionInfo* option : gi::engine_options())
        if (option->keeps) settings.set(*option, before.get(*option));
    return {};
}

std::span<const Action> picture_actions() {
    static constexpr std::array kActions = {
        Action{{GLFW_KEY_G}, "Picture", "Next engine", next_engine},
        Action{{GLFW_KEY_P}, "Picture", "Next preset", next_preset},
        Action{{GLFW_KEY_B}, "Picture", "One more bounce", more_bounces},
        Action{{GLFW_KEY_V}, "Picture", "One bounce less", fewer_bounces},
        Action{{GLFW_KEY_PAGE_UP}, "Picture", "Brighter", brighter},
        Action{{GLFW_KEY_PAGE_DOWN}, "Picture", "Darker", darker},
        Action{{GLFW_KEY_X}, "Picture", "Automatic exposure", automatic_exposure, nullptr, exposes_itself},
        Action{{GLFW_KEY_T, GLFW_MOD_ALT}, "Picture", "Next tone map", next_tone_map},
        Action{{GLFW_KEY_V, GLFW_MOD_ALT},
               "Picture",
               "Compare two engines",
               toggle_comparison,
               nullptr,
               compares},
        Action{{GLFW_KEY_B, GLFW_MOD_ALT},
               "Picture",
               "Compare by borders or differences",
               next_comparison,
               compares},
    };
    return kActions;
}

}  // namespace lucarne::viewer
