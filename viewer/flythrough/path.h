#pragma once

#include <filesystem>
#include <string>
#include <string_view>
#include <vector>

#include "gi/scene/scene.h"

namespace lucarne::viewer {

/// A camera at a time, as data/README.md ("Flythroughs") documents it.
struct KeyFrame {
    double time = 0;  ///< s
    gi::SceneCamera camera;
};

/// A camera's way through a scene: key frames joined by cubic Hermite curves with the tangents of Catmull &
/// Rom
/// ("A class of local interpolating splines", 1974) for uneven times, one-sided at both ends. The curves pass
/// through every key frame, and speed does not jump at any.
struct CameraPath {
    double frames_per_second = 25;
    std::vector<KeyFrame> keys;  ///< at least one, times growing

    double start() const { return keys.front().time; }
    double duration() const { return keys.back().time - keys.front().time; }  ///< s
    /// Frames at the path's own rate, the first at start() and the last not after its end.
    size_t frames() const;
    /// The camera at a time, which is clamped to the path's.
    gi::SceneCamera at(double time) const;
};

/// Errors name the file and the place: the line for syntax, the JSON pointer for everything else.
Result<CameraPath> load_path(const std::filesystem::path& path);
Result<CameraPath> parse_path(std::string_view text, const std::string& name);
/// The text of a path's file. Of a path that was parsed: parse_path() gives the same numbers again, to the
/// last bit.
std::string path_text(const CameraPath& path);

}  // namespace lucarne::viewer
