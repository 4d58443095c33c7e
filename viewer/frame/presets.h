#pragma once

#include <cstdint>
#include <span>
#include <string>
#include <string_view>

#include "gi/engine.h"
#include "gi/scene/render_settings.h"

namespace lucarne::viewer {

/// Limits on the points of a frame's cuts, and the resolution of the view cut.
struct CutBudgets {
    uint64_t view = 2'000'000;
    uint64_t light_view = 1'000'000;  ///< for each light
    uint64_t light = 1'000'000;
    double pixel_spacing = 1.0;  ///< projected spacing of points at which refinement stops, pixels

    /// Limits all budgets to `points` (--points).
    void cap(uint64_t points);

    bool operator==(const CutBudgets&) const = default;
};

/// How pictures are made: by which engine, with which options, from how many points.
struct Method {
    std::string engine;
    gi::EngineSettings settings;
    CutBudgets budgets;
    bool operator==(const Method&) const = default;
};

/// Settings that the user selects by one name. Published figures always name their preset.
struct Preset {
    std::string_view name;
    std::string_view description;
    gi::EngineSettings engine;
    CutBudgets budgets;
};

/// Replaces single settings of the preset's.
void apply(const gi::RenderSettings& settings, gi::EngineSettings& engine);
/// Returns the settings with which apply() turns this preset's options into `engine`. They contain the
/// preset's name, but no engine's name.
gi::RenderSettings settings_over(const Preset& preset, const gi::EngineSettings& engine);

inline constexpr std::string_view kDefaultPreset = "interactive";

/// All presets, cheapest first.
std::span<const Preset> presets();

/// Returns the preset called `name`. Errors (ErrorKind::arguments): unknown name; the message lists the known
/// ones.
Result<Preset> find_preset(std::string_view name);

}  // namespace lucarne::viewer
