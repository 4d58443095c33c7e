#pragma once

#include <cstddef>
#include <cstdint>
#include <optional>
#include <string>
#include <vector>

#include "gi/scene/scene.h"
#include "viewer/opening/moods.h"
#include "viewer/ui/command_queue.h"

namespace lucarne::viewer {

/// A part of a light that can be dragged in the picture.
struct LightHandle {
    enum class Part : uint8_t { position, target, sky } part = Part::position;
    size_t light = 0;
    bool operator==(const LightHandle&) const = default;
};

/// Read a sky picture.
struct LoadSky {
    std::string file;
};

/// What the window remembers for lights in addition to the scene.
struct LightModel {
    std::optional<Mood> mood;  ///< the mood that the lights are of; none once one of them was changed
    size_t selected = 0;       ///< index of the selected light
    bool show_handles = true;
    bool lumens = false;  ///< show strengths in lm and lx
    std::optional<LightHandle> held;
    std::string sky_image;  ///< path of the sky picture, as typed
    CommandQueue<LoadSky> commands;
    std::string reading_sky, sky_problem;  ///< the path being read; why the last picture is not shown
};

}  // namespace lucarne::viewer
