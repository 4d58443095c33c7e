#pragma once

#include <cstdint>
#include <span>
#include <string_view>

#include "gi/engine.h"
#include "gi/scene/render_settings.h"

namespace lucarne::viewer {

/// Points that the cuts of a frame may take, and how fine the view cut should be.
struct CutBudgets {
    uint64_t view = 2'000'000;
    uint64_t light_view = 1'000'000;  ///< for each light
    uint64_t light = 1'000'000;
    double pixel_spacing = 1.0;  ///< projected spacing of the points that refinement stops at, pixels

    /// No cut takes more than `points` (--points).
    void cap(uint64_t points);

    bool operator==(const CutBudgets&) const = default;
};

/// What a user picks by one word. Figures are always quoted with a preset.
struct Preset {
    std::string_view name;
    std::string_view description;
    gi::EngineSettings engine;
    CutBudgets budgets;
};

/// Single settings in the place of the preset's.
void apply(const gi::RenderSettings& settings, gi::EngineSettings& engine);
/// What apply() makes `engine` of from this preset's; says the preset's name, and no engine.
gi::RenderSettings settings_over(const Preset& preset, const gi::EngineSettings& engine);

inline constexpr std::string_view kDefaultPreset = "interactive";

/// All presets, cheapest first.
std::span<const Preset> presets();

/// Errors (ErrorKind::arguments): unknown name; the message lists the known ones.
Result<Preset> find_preset(std::string_view name);

}  // namespace lucarne::viewer
