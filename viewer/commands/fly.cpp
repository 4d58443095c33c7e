#include <algorithm>
#include <atomic>
#include <chrono>
#include <memory>
#include <optional>
#include <string>
#include <vector>

#include <fmt/format.h>

#include "gi/registry.h"
#include "io/core/log.h"
#include "io/files/file.h"
#include "io/files/json.h"
#include "io/files/page_cache.h"
#include "viewer/commands/commands.h"
#include "viewer/commands/options/drawing_options.h"
#include "viewer/commands/options/input_options.h"
#include "viewer/commands/options/outputs.h"
#include "viewer/flythrough/compare_flights.h"
#include "viewer/flythrough/flight.h"
#include "viewer/flythrough/html_report.h"
#include "viewer/flythrough/video.h"
#include "viewer/inputs/input.h"

namespace lucarne::viewer {
namespace {

using Json = nlohmann::ordered_json;
using Clock = std::chrono::steady_clock;

struct FlyOptions {
    InputOptions input{.required = false};  // --compare takes no input
    std::vector<std::string> compare;
    std::string path, report, html, frames_folder, video;
    DrawingOptions drawing;
    double soak = 0, frame_time_ms = 0, margin = 3;
    std::optional<double> light_time_ms;
    bool wait = false, realtime = false, cold = false, flicker = false, popping = false, overwrite = false;
};

std::vector<std::string> engines_of(const FlyOptions& options) {
    std::vector<std::string> names;
    std::istringstream list(options.drawing.render.engine);
    for (std::string name; std::getline(list, name, ',');) names.push_back(name);
    return names;
}

/// One flight of a call.
struct Plan {
    std::string engine;
    bool cold = false;
    std::string frames_folder;  ///< empty: write no frames
};

/// Plans one flight for every engine, cold before warm. With several flights each writes its frames to its
/// own folder.
std::vector<Plan> plans_of(const FlyOptions& options) {
    std::vector<Plan> plans;
    for (const std::string& engine : engines_of(options)) {
        if (options.cold) plans.push_back({engine, true, {}});
        plans.push_back({engine, false, {}});
    }
    for (Plan& plan : plans) {
        if (options.frames_folder.empty()) continue;
        const std::filesystem::path base = options.frames_folder;
        plan.frames_folder = plans.size() == 1 ? base : base / (plan.engine + (plan.cold ? "-cold" : ""));
    }
    return plans;
}

/// Checks arguments and outputs before long work starts.
Result<void> check(const FlyOptions& options) {
    if (options.input.paths.empty())
        return bad_arguments("INPUT", "is missing", "name a cache or a scan file");
    if (options.path.empty()) return bad_arguments("--path", "is missing", "name a camera path");
    if (options.report.empty()) return bad_arguments("--output", "is missing", "name the report's file");
    if (options.frame_time_ms > 0 && !options.realtime)
        return bad_arguments("--frame-time",
                             "needs --realtime: flights that wait draw the same on every run");
    auto inputs = options.input.paths;
    inputs.insert(inputs.end(), {options.path, options.drawing.scene});
    LUCARNE_TRY(check_outputs({options.report, options.html, options.video}, options.overwrite, inputs));
    if (!options.video.empty()) {
        if (options.realtime || options.soak > 0 || plans_of(options).size() > 1)
            return bad_arguments("--video", "needs a single flight with --wait",
                                 "leave out --realtime, --soak, --cold and further engines");
        LUCARNE_TRY(VideoWriter::check(options.video, options.overwrite));
    }
    for (const Plan& plan : plans_of(options)) {
        LUCARNE_TRY(gi::find_engine(plan.engine));
        if (plan.frames_folder.empty()) continue;
        LUCARNE_TRY(prepare_frames_folder(plan.frames_folder, options.overwrite));
    }
    return {};
}

/// Flies the path again with all points, to compare the changes from picture to picture.
Result<FullFlight> fly_at_full_resolution(Pipeline& pipeline, const CameraPath& path, FlightOptions how) {
    const CutBudgets budgets = pipeline.budgets();
    pipeline.set_budgets({.view = UINT64_MAX,
                          .light_view = budgets.light_view,
                          .light = budgets.light,
                          .pixel_spacing = 1e-6});
    how.wait = true;
    how.frames_folder.reset();
    how.take_frame = nullptr;
    how.soak = 0;
    LUCARNE_ASSIGN(Flight flight, fly(pipeline, path, how));
    pipeline.set_budgets(budgets);
    FullFlight full{std::move(flight.frames), 1};
    for (const FlownFrame& frame : full.frames)
        full.cut_share = std::min(full.cut_share, frame.stats.cut_share);
    return full;
}

Result<Json> fly_once(const FlyOptions& options, const Plan& plan, const CameraPath& path) {
    DrawingOptions drawing_options = options.drawing;
    drawing_options.render.engine = plan.engine;
    LUCARNE_ASSIGN(const Drawing drawing, resolve(drawing_options));
    LUCARNE_ASSIGN(const auto device, gi::Device::headless());
    FlightConditions conditions;
    conditions.start.cold = plan.cold;
    if (plan.cold)
        for (const std::string& input : options.input.paths) {
            LUCARNE_ASSIGN(const double held, drop_page_cache(input));
            conditions.start.still_cached = std::max(conditions.start.still_cached, held);
        }
    const auto begin = Clock::now();
    LUCARNE_ASSIGN(const auto source, open_input(options.input));
    LUCARNE_ASSIGN(SceneForScan loaded, load_scene_for(drawing_options, *source));
    drawing_options.render.engine = loaded.engine;
    loaded.first_view = false;                     // the path has the cameras
    LUCARNE_TRY(path.lights.check(loaded.scene));  // before paths are computed in advance
    LUCARNE_ASSIGN(const auto pipeline,
                   open_pipeline(*device, source, drawing_options, drawing, loaded.scene));
    conditions.start.open_seconds = std::chrono::duration<double>(Clock::now() - begin).count();

    FlightOptions how{drawing.size, !options.realtime, {}, options.overwrite};
    how.site = loaded.site;
    how.scene = loaded.scene;
    how.flicker = options.flicker;
    how.changes = options.popping;
    how.soak = options.soak;
    how.frame_time = options.frame_time_ms * 1e-3;
    if (options.light_time_ms) how.light_seconds = *options.light_time_ms * 1e-3;
    if (!plan.frames_folder.empty()) how.frames_folder = plan.frames_folder;
    const std::atomic<bool> stop{false};
    std::unique_ptr<VideoWriter> video;
    if (!options.video.empty()) {
        LUCARNE_ASSIGN(video, VideoWriter::start(options.video, how.size, path.frames_per_second,
                                                 options.overwrite, stop));
        how.take_frame = [&](const io::Image8& picture, size_t) { return video->add(picture); };
    }
    LUCARNE_ASSIGN(Flight flight, fly(*pipeline, path, how));
    if (video) LUCARNE_TRY(video->finish());
    if (options.popping) {
        LUCARNE_ASSIGN(conditions.full, fly_at_full_resolution(*pipeline, path, how));
    }
    conditions.inputs = options.input.paths;
    conditions.path = options.path;
    conditions.engine = loaded.engine;
    conditions.preset = options.drawing.render.preset;
    conditions.mode = options.realtime ? "realtime" : "wait";
    conditions.size = drawing.size;
    conditions.device = device->info();
    conditions.settings = drawing.preset.engine;
    conditions.budgets = drawing.preset.budgets;
    conditions.caps = drawing.caps;
    conditions.frame_time = how.frame_time;
    conditions.light_seconds = how.light_seconds;
    conditions.wall_seconds = flight.wall_seconds;
    conditions.soak = flight.soak;
    conditions.build = build_info();
    conditions.machine = machine_info();
    Json report = flight_report(conditions, flight.frames);
    log::info("{}: {} frames, median {:.1f} ms, 95th percentile {:.1f} ms; {}", flight_name(report),
              flight.frames.size(), report["frame_ms"]["p50"].get<double>(),
              report["frame_ms"]["p95"].get<double>(),
              memory_text(drawing.caps, flight.frames.back().stats.memory));
    if (const std::string chosen = chosen_text(loaded); !chosen.empty()) log::info("{}", chosen);
    return report;
}

Result<void> fly_all(FlyOptions options) {
    LUCARNE_TRY(take_render_settings(options.drawing));
    LUCARNE_TRY(check(options));
    LUCARNE_ASSIGN(const CameraPath path, load_path(options.path));
    std::vector<Json> flights;
    for (const Plan& plan : plans_of(options)) {
        LUCARNE_ASSIGN(flights.emplace_back(), fly_once(options, plan, path));
    }
    // A single flight is the whole report.
    const Json report = flights.size() == 1 ? flights.front() : Json{{"flights", flights}};
    LUCARNE_TRY(write_file(options.report, json_text(report), options.overwrite));
    if (!options.html.empty()) LUCARNE_TRY(write_file(options.html, html_report(flights), options.overwrite));
    log::info("{}{}", options.report, options.html.empty() ? "" : ", " + options.html);
    return {};
}

/// Compares B's flights with A's flights of the same engine, mode and start. If each report has a single
/// flight, compares these two.
Result<void> compare(const FlyOptions& options) {
    LUCARNE_ASSIGN(const auto before, read_flights(options.compare[0]));
    LUCARNE_ASSIGN(const auto after, read_flights(options.compare[1]));
    size_t compared = 0;
    std::string slower;
    for (const FlownReport& b : after) {
        const bool alone = before.size() == 1 && after.size() == 1;
        const auto a = std::ranges::find_if(
            before, [&](const FlownReport& other) { return alone || other.name() == b.name(); });
        if (a == before.end()) continue;
        const FlightComparison comparison = compare_flights(*a, b, options.margin / 100);
        const std::string names = a->name() == b.name() ? b.name() : a->name() + " and " + b.name();
        log::info("{}: {}", names, verdict_text(comparison, *a, b));
        if (comparison.verdict == Verdict::slower) slower += (slower.empty() ? "" : "; ") + names;
        ++compared;
    }
    if (compared == 0)
        return rejected(options.compare[1],
                        "has no flight of an engine and mode that the other report has, too");
    if (!slower.empty())
        return failed(options.compare[1], "is slower than " + options.compare[0] + " (" + slower + ")");
    return {};
}

}  // namespace

void add_fly(CommandLine& line) {
    auto options = std::make_shared<FlyOptions>();
    Arguments command = line.add("fly", "Fly along a camera path and measure it, or compare two reports");
    command.add("--path", options->path, "The camera path (data/README.md, Flythroughs)");
    command.add("-o,--output", options->report, "The report, JSON");
    command.add("--html", options->html, "Also write the report as a page with plots").type_name("FILE");
    add_drawing_options(command, options->drawing);
    add_input_options(command, options->input);
    command.find("--engine").description("Method of lighting; several make one flight each: vpl,direct");
    const Argument wait =
        command.flag("--wait", options->wait,
                     "Draw every frame with complete cuts: the same pixels on every run (default)");
    command.flag("--realtime", options->realtime, "Follow the clock and never wait, as in the window")
        .excludes(wait);
    command
        .add("--frame-time", options->frame_time_ms,
             "With --realtime: choose the points of cuts so that frames take this time")
        .range(1.0, 1e5)
        .type_name("MS");
    command
        .add("--light-time", options->light_time_ms,
             "Time of a frame for light that later frames show as well; 0: one step of it, the same on every "
             "run "
             "(default: 30 or three tenths of --frame-time; with --wait all that there is)")
        .range(0.0, 1e6)
        .type_name("MS");
    command.flag("--cold", options->cold,
                 "Before each flight make a cold one: the system's cache of the files is dropped first");
    command.add("--soak", options->soak, "Repeat the path for this time and compare memory use")
        .range(0.0, 1e6)
        .type_name("SECONDS");
    command.add("--frames-dir", options->frames_folder,
                "Write every frame to this folder: frame_00001.png and so on (for a video: README.md)");
    command
        .add("--video", options->video,
             "Make a video of all frames with ffmpeg, which must be installed: FILE.mp4, .mkv, .webm")
        .type_name("FILE");
    command.flag("--flicker", options->flicker,
                 "Also report each frame's mean luminance and how much the light of surfaces changes");
    command.flag(
        "--popping", options->popping,
        "Also report how much pictures change from frame to frame, compared with the same flight with "
        "all points");
    command
        .add("--compare", options->compare,
             "Compare two reports: is the second slower (exit code 1), faster, or neither?")
        .values(2)
        .type_name("A.json B.json");
    command.add("--margin", options->margin, "Ignore differences up to this, per cent")
        .range(0.0, 1000.0)
        .show_default()
        .type_name("PERCENT");
    command.flag("--overwrite", options->overwrite, "Replace files that exist");
    command.run([options] { return options->compare.empty() ? fly_all(*options) : compare(*options); });
}

}  // namespace lucarne::viewer
