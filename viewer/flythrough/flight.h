#pragma once

#include <filesystem>
#include <functional>
#include <optional>
#include <vector>

#include "viewer/flythrough/path.h"
#include "viewer/flythrough/report.h"

namespace lucarne::viewer {

struct FlightOptions {
    ImageSize size{1280, 720};
    /// True: every frame of the path, every cut whole: the same pixels on every run. False: what a user sees:
    /// the camera goes by the clock, and a frame shows what has been loaded when its time comes.
    bool wait = true;
    std::optional<std::filesystem::path> frames_folder;  ///< frame_00001.png and so on
    bool overwrite = false;
    bool flicker = false;  ///< measure FlownFrame::flicker and ::luminance, while the clock stands still
};

struct Flight {
    std::vector<FlownFrame> frames;
    double wall_seconds = 0;
};

/// Flies a pipeline that is set up along a path. Frames are written while the clock stands still, so that
/// writing slows nothing down that is measured. Errors: the pipeline's, a frame that cannot be written.
Result<Flight> fly(Pipeline& pipeline, const CameraPath& path, const FlightOptions& options);

}  // namespace lucarne::viewer
