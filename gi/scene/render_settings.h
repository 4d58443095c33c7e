#pragma once

#include <optional>
#include <string>

#include "gi/options.h"

namespace lucarne::gi {

/// How a picture is computed, as scene files and options state it. Empty values are left to the preset and
/// to the defaults.
struct RenderSettings {
    std::string engine, preset;
    EngineSettings options;  ///< those that are given; they override the preset's
    /// Resolution of the window's pictures over the window's own, kLeastPictureScale to 1; the pictures are
    /// scaled up.
    std::optional<double> scale;

    bool operator==(const RenderSettings&) const = default;
};

inline constexpr double kLeastPictureScale = 0.25;

}  // namespace lucarne::gi
