#pragma once

#include <optional>
#include <string>

#include "viewer/style/clip_handles.h"

namespace lucarne::viewer {

/// What the window remembers for the points' look in addition to the scene's look.
struct LookModel {
    std::string lit_engine;  ///< engine that switching light on restores; empty: the default
    std::optional<ClipHandle> held;
    bool show_handles = true;
};

}  // namespace lucarne::viewer
