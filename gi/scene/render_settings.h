#pragma once

#include <optional>
#include <string>

#include "gi/options.h"

namespace lucarne::gi {

/// How a picture is computed, as scene files and options say it. What is empty is left to the preset and to
/// the defaults.
struct RenderSettings {
    std::string engine, preset;
    EngineSettings options;  ///< those that are said, over the preset's
    /// Of the window's sides, which its pictures are made at and scaled up from; kLeastPictureScale to 1.
    std::optional<double> scale;

    bool operator==(const RenderSettings&) const = default;
};

inline constexpr double kLeastPictureScale = 0.25;

}  // namespace lucarne::gi
