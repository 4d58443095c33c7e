#pragma once

#include <cstdint>
#include <optional>
#include <string>

namespace lucarne::gi {

/// How a picture is computed, as scene files and options say it. What is empty is left to the preset and to
/// the defaults.
struct RenderSettings {
    std::string engine, preset;
    // Of EngineSettings, over the preset's:
    std::optional<uint32_t> bounces, only_bounce, vpls, interleave, atlas, light_resolution, samples;
    /// Of the window's sides, which its pictures are made at and scaled up from; kLeastPictureScale to 1.
    std::optional<double> scale;

    bool operator==(const RenderSettings&) const = default;
};

inline constexpr double kLeastPictureScale = 0.25;

}  // namespace lucarne::gi
