#pragma once

#include <filesystem>
#include <functional>
#include <optional>
#include <vector>

#include "io/image/image.h"
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
    /// Takes the picture of every frame, too; the first has the number 1. An error ends the flight.
    std::function<Result<void>(const io::Image8& picture, size_t number)> take_frame{};
    bool flicker = false;  ///< measure FlownFrame::flicker and ::luminance, while the clock stands still
    bool changes = false;  ///< measure FlownFrame::change, likewise
    double soak = 0;       ///< s; the path is flown again and again for at least so long
    /// In seconds: by the clock, the budgets of cuts follow it (cost_model.h); 0: they are fixed.
    double frame_time = 0;
};

struct Flight {
    std::vector<FlownFrame> frames;  ///< of a soak evenly kLongestRecord of them at most
    double wall_seconds = 0;
    std::optional<Soak> soak;
};

inline constexpr size_t kLongestRecord = 8192;

/// Makes the folder for frames where it is missing. Errors: it cannot be made; there are frames in it
/// already.
Result<void> prepare_frames_folder(const std::filesystem::path& folder, bool overwrite);

/// Flies a pipeline that is set up along a path. Frames are written and measured while the clock stands
/// still, so that this slows nothing down that is measured. Errors: the pipeline's, a frame that cannot be
/// written.
Result<Flight> fly(Pipeline& pipeline, const CameraPath& path, const FlightOptions& options);

}  // namespace lucarne::viewer
