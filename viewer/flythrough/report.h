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

/// What a flythrough measured of one frame.
struct FlownFrame {
    double time = 0;  ///< on the path, s
    double wall = 0;  ///< since the flight's start, when it was done, s
    size_t lap = 0;   ///< of a soak
    FrameStats stats;
    // Where they were measured:
    std::optional<double> luminance;      ///< mean of the picture, W/(sr m^2)
    std::optional<Flicker> flicker;       ///< since the frame before
    std::optional<PictureChange> change;  ///< likewise
};

/// A path flown again and again.
struct Soak {
    size_t laps = 0, frames = 0;
    MemoryUse first, last;  ///< at the end of the first lap, when all has been in use once, and of the last
};

/// How the first picture came about.
struct FlightStart {
    bool cold = false;        ///< the kernel was made to forget the files before
    double still_cached = 0;  ///< share of their bytes that it did not forget
    double open_seconds = 0;  ///< for opening the files and the pipeline
};

/// The same flight drawn with every point there is.
struct FullFlight {
    std::vector<FlownFrame> frames;
    double cut_share = 1;  ///< of all points that were wanted, the least that fitted the caps
};

/// What was flown with.
struct FlightConditions {
    std::vector<std::string> inputs;
    std::string path, engine, preset, mode;
    ImageSize size;
    gi::DeviceInfo device;
    gi::EngineSettings settings;
    CutBudgets budgets;
    PipelineOptions caps;
    double frame_time = 0;    ///< s, that the cuts followed; 0: none
    double wall_seconds = 0;  ///< of the flight, without the writing of pictures
    FlightStart start;
    std::optional<Soak> soak;
    std::optional<FullFlight> full;
    BuildInfo build;
    MachineInfo machine;
};

/// The q-quantile (0 to 1) of values, by linear interpolation between the ranks (Hyndman & Fan 1996, type 7);
/// 0 for none.
double quantile(std::vector<double> values, double q);

/// The report as data/README.md ("Flythroughs") describes it.
nlohmann::ordered_json flight_report(const FlightConditions& conditions, std::span<const FlownFrame> frames);

}  // namespace lucarne::viewer
