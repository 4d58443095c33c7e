#include "viewer/frame/presets.h"

#include <algorithm>
#include <array>
#include <string>

#include <fmt/format.h>

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
               {.bounces = 1,
                .vpls = 64,
                .interleave = 4,
                .atlas = 1024,
                .light_resolution = 256,
                .light_samples = 4,
                .samples = 4},
               {.view = 1'000'000, .light_view = 250'000, .light = 250'000, .pixel_spacing = 1.5}},
        Preset{"interactive",
               "while the camera moves: 256 VPLs, 4x4 interleaved, light cut of 1M points",
               {.bounces = 1,
                .vpls = 256,
                .interleave = 4,
                .atlas = 1024,
                .light_resolution = 512,
                .light_samples = 8,
                .samples = 16},
               {.view = 2'000'000, .light_view = 1'000'000, .light = 1'000'000, .pixel_spacing = 1.0}},
        Preset{"high",
               "for pictures: 1024 VPLs, every pixel lit by all of them, fine cuts",
               {.bounces = 1,
                .vpls = 1024,
                .interleave = 1,
                .atlas = 4096,
                .light_resolution = 1024,
                .light_samples = 32,
                .samples = 64},
               {.view = 4'000'000, .light_view = 2'000'000, .light = 2'000'000, .pixel_spacing = 0.7}},
    };
    return all;
}

void apply(const gi::RenderSettings& settings, gi::EngineSettings& engine) {
    engine.bounces = settings.bounces.value_or(engine.bounces);
    if (settings.only_bounce) engine.only_bounce = static_cast<int32_t>(*settings.only_bounce);
    engine.vpls = settings.vpls.value_or(engine.vpls);
    engine.interleave = settings.interleave.value_or(engine.interleave);
    engine.atlas = settings.atlas.value_or(engine.atlas);
    engine.light_resolution = settings.light_resolution.value_or(engine.light_resolution);
    engine.samples = settings.samples.value_or(engine.samples);
}

gi::RenderSettings settings_over(const Preset& preset, const gi::EngineSettings& engine) {
    gi::RenderSettings settings;
    settings.preset = preset.name;
    const auto put = [](std::optional<uint32_t>& setting, uint32_t value, uint32_t usual) {
        if (value != usual) setting = value;
    };
    put(settings.bounces, engine.bounces, preset.engine.bounces);
    if (engine.only_bounce >= 0) settings.only_bounce = static_cast<uint32_t>(engine.only_bounce);
    put(settings.vpls, engine.vpls, preset.engine.vpls);
    put(settings.interleave, engine.interleave, preset.engine.interleave);
    put(settings.atlas, engine.atlas, preset.engine.atlas);
    put(settings.light_resolution, engine.light_resolution, preset.engine.light_resolution);
    put(settings.samples, engine.samples, preset.engine.samples);
    return settings;
}

Result<Preset> find_preset(std::string_view name) {
    std::string known;
    for (const auto& preset : presets()) {
        if (preset.name == name) return preset;
        known += fmt::format("{}{}", known.empty() ? "" : ", ", preset.name);
    }
    return bad_arguments("--preset", fmt::format("there is no preset '{}'", name), "choose one of: " + known);
}

}  // namespace lucarne::viewer
