#pragma once

#include <filesystem>
#include <functional>
#include <optional>
#include <vector>

#include "io/image/image.h"
#include "viewer/flythrough/path.h"
#include "viewer/flythrough/report.h"
#include "viewer/opening/site.h"

namespace lucarne::viewer {

struct FlightOptions {
    ImageSize size{1280, 720};
    /// True: draws every frame of the path with complete cuts, so that the pixels are the same on every run.
    /// False: draws what a user sees: the camera follows the clock, and a frame shows the nodes loaded by
    /// then.
    bool wait = true;
    std::optional<std::filesystem::path> frames_folder;  ///< gets frame_00001.png and so on
    bool overwrite = false;
    /// Called with the picture of every frame; the first frame has the number 1. An error ends the flight.
    std::function<Result<void>(const io::Image8& picture, size_t number)> take_frame{};
    bool flicker = false;  ///< measure FlownFrame::flicker and ::luminance with the clock paused
    bool changes = false;  ///< measure FlownFrame::change, with the clock paused
    double soak = 0;       ///< s; the path is repeated for at least this time; 0: it is flown once
    /// Target time of a frame, s. Without `wait`, the budgets of cuts follow it (cost_model.h). 0: budgets
    /// are fixed.
    double frame_time = 0;
    /// Time of each frame for making light that outlasts it, s (FrameRequest::light_budget). By default
    /// unlimited with `wait`, and kLightShare of the frame's time otherwise.
    std::optional<double> light_seconds;
    /// What the path's lights light: the pipeline's scene with all its lights, also those that do not shine.
    /// Needed only for paths with light tracks.
    gi::Scene scene{};
    /// What the scan shows: outside its rooms, points that face away are not drawn. None: all points are.
    std::optional<Site> site;
};

struct Flight {
    std::vector<FlownFrame> frames;  ///< of a soak at most kLongestRecord frames, evenly spread
    double wall_seconds = 0;
    std::optional<Soak> soak;
};

inline constexpr size_t kLongestRecord = 8192;

/// Makes the folder for frames if it is missing. Errors: the folder cannot be made; it contains frames
/// already and `overwrite` is false.
Result<void> prepare_frames_folder(const std::filesystem::path& folder, bool overwrite);

/// Flies along a path with a pipeline that has been set up. The clock pauses while frames are written and
/// analysed, so that this does not affect the measured times. A path with light tracks sets the pipeline's
/// scene. Errors: those of the pipeline; a frame cannot be written; the tracks do not fit the scene.
Result<Flight> fly(Pipeline& pipeline, const CameraPath& path, const FlightOptions& options);

}  // namespace lucarne::viewer
