#include "viewer/frame/presets.h"

#include <algorithm>
#include <array>
#include <string>

#include <fmt/format.h>

#include "io/core/options.h"

namespace lucarne::viewer {

void CutBudgets::cap(uint64_t points) {
    view = std::min(view, points);
    light_view = std::min(light_view, points);
    light = std::min(light, points);
}

std::span<const Preset> presets() {
    static const std::array<Preset, 3> all = {
        Preset{"preview",
               "while something is being set up: 64 VPLs, 4x4 interleaved, coarse cuts",
               gi::default_settings(gi::Effort::preview),
               {.view = 1'000'000, .light_view = 250'000, .light = 250'000, .pixel_spacing = 1.5}},
        Preset{"interactive",
               "while the camera moves: 256 VPLs, 4x4 interleaved, light cut of 1M points",
               gi::default_settings(gi::Effort::interactive),
               {.view = 2'000'000, .light_view = 1'000'000, .light = 1'000'000, .pixel_spacing = 1.0}},
        Preset{"high",
               "for pictures: 1024 VPLs, every pixel lit by all of them, fine cuts",
               gi::default_settings(gi::Effort::high),
               {.view = 4'000'000, .light_view = 2'000'000, .light = 2'000'000, .pixel_spacing = 0.7}},
    };
    return all;
}

void apply(const gi::RenderSettings& settings, gi::EngineSettings& engine) {
    engine.override_with(settings.options);
}

gi::RenderSettings settings_over(const Preset& preset, const gi::EngineSettings& engine) {
    gi::RenderSettings settings;
    settings.preset = preset.name;
    for (const gi::OptionInfo* option : gi::engine_options())
        if (engine.get(*option) != preset.engine.get(*option))
            settings.options.set(*option, engine.get(*option));
    return settings;
}

Result<Preset> find_preset(std::string_view name) {
    std::vector<std::string_view> names;
    for (const auto& preset : presets()) {
        if (preset.name == name) return preset;
        names.push_back(preset.name);
    }
    return bad_arguments("--preset", fmt::format("unknown preset '{}'", name), advice(name, names));
}

}  // namespace lucarne::viewer
