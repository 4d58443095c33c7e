#pragma once

#include <optional>
#include <span>
#include <string>
#include <vector>

#include <nlohmann/json.hpp>

#include "io/core/machine.h"
#include "viewer/flythrough/flicker.h"
#include "viewer/flythrough/picture_change.h"
#include "viewer/frame/pipeline.h"

namespace lucarne::viewer {

/// The measurements of one frame of a flythrough.
struct FlownFrame {
    double time = 0;  ///< on the path, s
    double wall = 0;  ///< from the flight's start until the frame was done, s
    size_t lap = 0;   ///< number of the lap in a soak
    FrameStats stats;
    // Set if they were measured:
    std::optional<double> luminance;      ///< mean luminance of the picture, W/(sr m^2)
    std::optional<Flicker> flicker;       ///< since the frame before
    std::optional<PictureChange> change;  ///< since the frame before
};

/// The result of a soak, which repeats the path.
struct Soak {
    size_t laps = 0, frames = 0;
    MemoryUse first, last;  ///< at the end of the first lap, when everything has been used, and of the last
};

/// How the flight started, up to the first picture.
struct FlightStart {
    bool cold = false;        ///< the files were dropped from the kernel's page cache before
    double still_cached = 0;  ///< share of their bytes that stayed in the page cache
    double open_seconds = 0;  ///< time to open the files and the pipeline
};

/// The same flight drawn with all points.
struct FullFlight {
    std::vector<FlownFrame> frames;
    double cut_share = 1;  ///< least share of the wanted points that fitted the caps
};

/// The conditions of a flight.
struct FlightConditions {
    std::vector<std::string> inputs;
    std::string path, engine, preset, mode;
    ImageSize size;
    gi::DeviceInfo device;
    gi::EngineSettings settings;
    CutBudgets budgets;
    PipelineOptions caps;
    double frame_time = 0;                ///< s, the target that the cuts followed; 0: no target
    std::optional<double> light_seconds;  ///< FlightOptions::light_seconds
    double wall_seconds = 0;              ///< duration of the flight without the writing of pictures
    FlightStart start;
    std::optional<Soak> soak;
    std::optional<FullFlight> full;
    BuildInfo build;
    MachineInfo machine;
};

/// Returns the q-quantile (q in 0 to 1) of values by linear interpolation between the ranks (Hyndman & Fan
/// 1996, type 7), or 0 if there are no values.
double quantile(std::vector<double> values, double q);

/// Returns the report that data/README.md ("Flythroughs") describes.
nlohmann::ordered_json flight_report(const FlightConditions& conditions, std::span<const FlownFrame> frames);

}  // namespace lucarne::viewer
