#pragma once

#include <chrono>
#include <cstddef>
#include <cstdint>
#include <filesystem>
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

/// Light paths in advance (prepared_engine()): what the window knows of them beside View::is_prepared.
struct Preparation {
    uint64_t points = 0;                ///< of the open scans
    bool grows = false;                 ///< more of them are to come
    bool wanted = false;                ///< the user has asked for it, and it has not ended
    uint64_t asked = 0;                 ///< how often the user has
    std::string engine_before;          ///< that drew pictures then; empty: the prepared one did already
    std::filesystem::path place, file;  ///< where it would be kept; where it is kept; empty: nowhere
    uint64_t file_bytes = 0;
    bool kept_read = false;                                      ///< whether `kept_share` is known
    std::optional<double> kept_share;                            ///< of the file at `place`; none: no file
    bool whole = false;                                          ///< the newest picture had all of it
    std::string problem;                                         ///< why it has failed, or is not kept
    std::optional<std::chrono::steady_clock::time_point> begun;  ///< when work on it was first seen
    double share_at_begin = 0;                                   ///< and its share then
};

/// What the window remembers for lights in addition to the scene.
struct LightModel {
    std::optional<Mood> mood;  ///< the mood that the lights are of; none once one of them was changed
    size_t selected = 0;       ///< index of the selected light
    bool show_handles = true;
    bool plays_day = false;  ///< the sun goes through its day
    Preparation preparation;
    bool lumens = false;  ///< show strengths in lm and lx
    std::optional<LightHandle> held;
    std::string sky_image;  ///< path of the sky picture, as typed
    CommandQueue<LoadSky> commands;
    std::string reading_sky, sky_problem;  ///< the path being read; why the last picture is not shown
};

}  // namespace lucarne::viewer
