#include <memory>
#include <string>

#include <CLI/CLI.hpp>

#include "io/core/file.h"
#include "io/core/log.h"
#include "viewer/commands/commands.h"
#include "viewer/commands/drawing_options.h"
#include "viewer/flythrough/flight.h"
#include "viewer/input.h"

namespace lucarne::viewer {
namespace {

struct FlyOptions {
    std::string input, path, report, frames_folder;
    DrawingOptions drawing;
    bool wait = false, realtime = false, flicker = false, overwrite = false;
};

/// Everything that can be wrong with the outputs, before long work starts.
Result<void> check_outputs(const FlyOptions& options) {
    LUCARNE_TRY(check_output(options.report, options.overwrite));
    if (options.frames_folder.empty()) return {};
    std::error_code error;
    std::filesystem::create_directories(options.frames_folder, error);
    if (error) return failed(options.frames_folder, error.message(), "name a folder that can be written");
    return check_output(std::filesystem::path(options.frames_folder) / "frame_00001.png", options.overwrite);
}

Result<void> fly_command(const FlyOptions& options) {
    LUCARNE_ASSIGN(const Drawing drawing, resolve(options.drawing));
    LUCARNE_ASSIGN(const CameraPath path, load_path(options.path));
    LUCARNE_TRY(check_outputs(options));
    LUCARNE_ASSIGN(const auto source, open_input(options.input));
    LUCARNE_ASSIGN(gi::Scene scene, load_scene_for(options.drawing, source->header()));
    LUCARNE_ASSIGN(const auto device, gi::Device::headless());
    LUCARNE_ASSIGN(const auto pipeline,
                   open_pipeline(*device, source, options.drawing, drawing, std::move(scene)));

    FlightOptions flight_options{drawing.size, !options.realtime, {}, options.overwrite};
    flight_options.flicker = options.flicker;
    if (!options.frames_folder.empty()) flight_options.frames_folder = options.frames_folder;
    LUCARNE_ASSIGN(const Flight flight, fly(*pipeline, path, flight_options));
    const FlightConditions conditions{options.input,
                                      options.path,
                                      options.drawing.engine,
                                      options.drawing.preset,
                                      options.realtime ? "realtime" : "wait",
                                      drawing.size,
                                      device->info(),
                                      drawing.preset.engine,
                                      drawing.preset.budgets,
                                      drawing.caps,
                                      flight.wall_seconds};
    const auto report = flight_report(conditions, flight.frames);
    LUCARNE_ASSIGN(auto file, OutputFile::create(options.report, options.overwrite));
    LUCARNE_TRY(file.append(report.dump(2) + "\n"));
    LUCARNE_TRY(file.commit());
    log::info("{} frames, {:.1f} ms in the middle, {:.1f} ms at 95 %; {}: {}", flight.frames.size(),
              report["frame_ms"]["p50"].get<double>(), report["frame_ms"]["p95"].get<double>(),
              memory_text(drawing.caps, flight.frames.back().stats.memory), options.report);
    return {};
}

}  // namespace

void add_fly(CLI::App& app, Command& chosen) {
    auto options = std::make_shared<FlyOptions>();
    auto* command = app.add_subcommand("fly", "Fly along a camera path and measure it");
    command->add_option("INPUT", options->input, "A cache or any scan file")->required();
    command->add_option("--path", options->path, "The camera path (data/README.md, Flythroughs)")->required();
    command->add_option("-o,--output", options->report, "The report, JSON")->required();
    add_drawing_options(*command, options->drawing);
    auto* wait = command->add_flag("--wait", options->wait,
                                   "Every frame, every cut whole: the same pixels on every run (default)");
    command->add_flag("--realtime", options->realtime, "By the clock, never waiting: what a user sees")
        ->excludes(wait);
    command->add_option("--frames-dir", options->frames_folder,
                        "Write every frame there, frame_00001.png and so on");
    command->add_flag("--flicker", options->flicker,
                      "Also report every frame's mean luminance and how much surfaces' light changes");
    command->add_flag("--overwrite", options->overwrite, "Replace what exists");
    command->callback([options, &chosen] { chosen = [options] { return fly_command(*options); }; });
}

}  // namespace lucarne::viewer
