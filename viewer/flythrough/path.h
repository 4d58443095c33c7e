#pragma once

#include <filesystem>
#include <string>
#include <string_view>
#include <vector>

#include "gi/scene/scene.h"
#include "viewer/flythrough/light_tracks.h"

namespace lucarne::viewer {

/// A camera at a given time; data/README.md ("Flythroughs") documents it.
struct KeyFrame {
    double time = 0;  ///< s
    gi::SceneCamera camera;
};

/// A camera path through a scene: key frames joined by the curves of curve_at(), and what the scene's lights
/// do meanwhile.
struct CameraPath {
    double frames_per_second = 25;
    std::vector<KeyFrame> keys;  ///< at least one, times strictly increasing
    LightTracks lights;          ///< their times are those of the key frames

    double start() const { return keys.front().time; }
    double duration() const { return keys.back().time - keys.front().time; }  ///< s
    /// Returns the number of frames at the path's rate, the first at start() and the last not after the
    /// path's end.
    size_t frames() const;
    /// Returns the camera at a time, which is clamped to the path's times.
    gi::SceneCamera at(double time) const;
};

/// Read a path. Errors name the file and the place: the line for syntax, the JSON pointer for everything
/// else.
Result<CameraPath> load_path(const std::filesystem::path& path);
Result<CameraPath> parse_path(std::string_view text, const std::string& name);
/// Returns the text of a path's file. If the path came from parse_path(), parsing this text gives the same
/// numbers to the last bit.
std::string path_text(const CameraPath& path);

}  // namespace lucarne::viewer
