#include <algorithm>
#include <array>
#include <cassert>

#define GLFW_INCLUDE_NONE
#include <GLFW/glfw3.h>
#include <fmt/format.h>

#include "gi/bounce_options.h"
#include "gi/registry.h"
#include "viewer/rendering/rendering.h"

namespace lucarne::viewer {
namespace {

using Entry = Action<const Rendering>;

constexpr double kExposureStep = 0.5;  ///< stops
constexpr uint32_t kMostBounces = 8;

void next_engine(const Rendering& model) {
    const auto engines = gi::engines();
    const auto now = std::ranges::find(engines, model.view.method.engine,
                                       [](const auto& entry) { return entry.info.name; });
    auto next = now == engines.end() || now + 1 == engines.end() ? engines.begin() : now + 1;
    while (next != now && !gi::can_run(next->info))
        next = next + 1 == engines.end() ? engines.begin() : next + 1;
    model.view.method.engine = next->info.name;
    model.view.message = fmt::format("{}: {}", next->info.label, next->info.description);
}

void next_preset(const Rendering& model) {
    const auto all = presets();
    const auto now = std::ranges::find(all, model.view.preset, &Preset::name);
    const Preset& next = now == all.end() || now + 1 == all.end() ? all.front() : now[1];
    if (model.view.choose_preset(next.name))
        model.view.message = fmt::format("preset {}: {}", next.name, next.description);
}

void change_bounces(const Rendering& model, int by) {
    const auto bounces = static_cast<uint32_t>(
        std::clamp<int64_t>(int64_t{model.view.method.settings[gi::kBounces]} + by, 0, kMostBounces));
    model.view.method.settings.set(gi::kBounces, bounces);
    model.view.message = fmt::format("{} indirect bounce{}", bounces, bounces == 1 ? "" : "s");
}
void more_bounces(const Rendering& model) {
    change_bounces(model, 1);
}
void fewer_bounces(const Rendering& model) {
    change_bounces(model, -1);
}

void change_exposure(const Rendering& model, double stops) {
    const double now =
        model.view.scene.exposure_ev.value_or(model.view.picture ? model.view.picture->exposure_ev : 0.0);
    model.view.scene.exposure_ev = std::clamp(now + stops, -40.0, 40.0);
    model.view.shown_changed();
    model.view.message = fmt::format("exposure {:+.1f} stops", *model.view.scene.exposure_ev);
}
void brighter(const Rendering& model) {
    change_exposure(model, kExposureStep);
}
void darker(const Rendering& model) {
    change_exposure(model, -kExposureStep);
}
void automatic_exposure(const Rendering& model) {
    model.view.scene.exposure_ev.reset();
    model.view.shown_changed();
    model.view.message = "automatic exposure";
}

bool exposes_itself(const Rendering& model) {
    return !model.view.scene.exposure_ev;
}

void next_tone_map(const Rendering& model) {
    const auto names = gi::tone_map_names();
    model.view.scene.tone_map =
        static_cast<gi::ToneMap>((static_cast<size_t>(model.view.scene.tone_map) + 1) % names.size());
    model.view.shown_changed();
    model.view.message = fmt::format("tone map {}", names[static_cast<size_t>(model.view.scene.tone_map)]);
}
bool compares(const Rendering& model) {
    return model.view.scene.comparison.has_value();
}
void toggle_comparison(const Rendering& model) {
    // Compare with direct light alone, to show what indirect light adds.
    const auto& direct = gi::engine_with(&gi::EngineInfo::direct_only);
    const auto& other = model.view.method.engine == direct.name ? gi::default_engine() : direct;
    compare_with(model.view, compares(model) ? "" : std::string(other.name));
}
void next_comparison(const Rendering& model) {
    const auto names = gi::comparison_names();
    auto& show = model.view.scene.comparison->show;
    show = static_cast<gi::Comparison::Show>((static_cast<size_t>(show) + 1) % names.size());
    model.view.shown_changed();
    model.view.message = fmt::format("comparison: {}", names[static_cast<size_t>(show)]);
}

}  // namespace

void compare_with(View& view, const std::string& engine) {
    assert(engine.empty() || gi::find_engine(engine));
    if (engine.empty()) {
        view.scene.comparison.reset();
    } else {
        if (!view.scene.comparison) view.scene.comparison.emplace();
        view.scene.comparison->engine = engine;
    }
    view.scene_changed();
}

std::span<const Action<const Rendering>> rendering_actions() {
    static constexpr std::array kActions = {
        Entry{{GLFW_KEY_G}, "Picture", "Next engine", next_engine},
        Entry{{GLFW_KEY_P}, "Picture", "Next preset", next_preset},
        Entry{{GLFW_KEY_B}, "Picture", "One more bounce", more_bounces},
        Entry{{GLFW_KEY_V}, "Picture", "One bounce less", fewer_bounces},
        Entry{{GLFW_KEY_PAGE_UP}, "Picture", "Brighter", brighter},
        Entry{{GLFW_KEY_PAGE_DOWN}, "Picture", "Darker", darker},
        Entry{{GLFW_KEY_X}, "Picture", "Automatic exposure", automatic_exposure, nullptr, exposes_itself},
        Entry{{GLFW_KEY_T, GLFW_MOD_ALT}, "Picture", "Next tone map", next_tone_map},
        Entry{{GLFW_KEY_V, GLFW_MOD_ALT},
              "Picture",
              "Compare two engines",
              toggle_comparison,
              nullptr,
              compares},
        Entry{{GLFW_KEY_B, GLFW_MOD_ALT},
              "Picture",
              "Compare by borders or differences",
              next_comparison,
              compares},
    };
    return kActions;
}

}  // namespace lucarne::viewer
