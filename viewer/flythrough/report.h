#pragma once

#include <optional>
#include <span>
#include <string>
#include <vector>

#include <nlohmann/json.hpp>

#include "viewer/flythrough/flicker.h"
#include "viewer/pipeline.h"

namespace lucarne::viewer {

/// What a flythrough measured of one frame.
struct FlownFrame {
    double time = 0;  ///< on the path, s
    FrameStats stats;
    // Where they were measured:
    std::optional<double> luminance;  ///< mean of the picture, W/(sr m^2)
    std::optional<Flicker> flicker;   ///< since the frame before
};

/// What was flown with.
struct FlightConditions {
    std::string input, path, engine, preset, mode;
    ImageSize size;
    gi::DeviceInfo device;
    gi::EngineSettings settings;
    CutBudgets budgets;
    PipelineOptions caps;
    double wall_seconds = 0;  ///< of the flight, without the writing of pictures
};

/// The q-quantile (0 to 1) of values, by linear interpolation between the ranks (Hyndman & Fan 1996, type 7);
/// 0 for none.
double quantile(std::vector<double> values, double q);

/// The report as data/README.md ("Flythroughs") describes it.
nlohmann::ordered_json flight_report(const FlightConditions& conditions, std::span<const FlownFrame> frames);

}  // namespace lucarne::viewer
