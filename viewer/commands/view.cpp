#include <algorithm>
#include <atomic>
#include <filesystem>
#include <memory>
#include <string>
#include <vector>

#include <glm/geometric.hpp>

#include "gi/bake/bake_file.h"
#include "gi/registry.h"
#include "io/core/log.h"
#include "viewer/commands/commands.h"
#include "viewer/commands/options/drawing_options.h"
#include "viewer/commands/options/input_options.h"
#include "viewer/commands/options/outputs.h"
#include "viewer/commands/options/shown_site.h"
#include "viewer/flythrough/path.h"
#include "viewer/frame/engine_bake.h"
#include "viewer/inputs/input.h"
#include "viewer/measure/file.h"
#include "viewer/opening/moods.h"
#include "viewer/project/project.h"
#include "viewer/window/view_session.h"

namespace lucarne::viewer {
namespace {

struct ViewOptions {
    InputOptions input;
    std::string camera, screenshot, measurements, path;
    DrawingOptions drawing;
    uint32_t frames = 1;
    double frame_time_ms = 100;
    bool overwrite = false;
    bool size_given = false;  ///< false: the window is as large as last time
    std::string project;      ///< the INPUT, if it is a project
    bool says_what = false;   ///< the command line says what to show: the project stays out of it
};

/// Returns the starting view of what is open. Called on a thread, because it reads nodes.
Result<StartingView> starting_view(const ViewOptions& options, const octree::NodeSource& source) {
    StartingView start;
    const auto engine = gi::find_engine(prepared_engine());
    if (engine) start.prepared_file = kept_bake((*engine)->info, source);
    if (const auto identity = source.identity())
        start.prepared_place = gi::bake_place(identity->file, prepared_engine());
    const bool is_prepared = !start.prepared_file.empty();
    LUCARNE_ASSIGN(SceneForScan loaded, load_scene_for(options.drawing, source, is_prepared));
    LUCARNE_ASSIGN(start.camera, find_camera(loaded.scene, options.camera));
    start.fits_window = loaded.first_view && options.camera.empty();
    start.scene = std::move(loaded.scene);
    if (options.drawing.scene.empty()) start.scene.look.axes = start.scene.look.scale_bar = true;
    start.mood = loaded.mood;
    start.engine = loaded.engine;
    start.site = loaded.site ? std::move(*loaded.site) : shown_site(source);
    start.box = start.site.box;
    start.metres_per_unit = source.header().metres_per_unit;
    return start;
}

/// Reports errors of the scene file before a window opens.
Result<void> check_scene(const ViewOptions& options) {
    if (options.drawing.scene.empty()) return {};
    LUCARNE_ASSIGN(const gi::Scene scene, gi::load_scene(options.drawing.scene));
    if (!scene.cameras.empty()) LUCARNE_TRY(find_camera(scene, options.camera));
    return {};
}

/// Recognises a project among the inputs, and reports its errors before a window opens. Errors: it is not the
/// only input; other options say what to show; without a user to ask, none of its scans is there.
Result<void> take_project(ViewOptions& options) {
    auto& paths = options.input.paths;
    const auto found = std::ranges::find_if(paths, [](const std::string& path) {
        return std::filesystem::path(path).extension() == ".json" && is_project(path);
    });
    if (found == paths.end()) return {};
    if (paths.size() > 1) return bad_arguments(*found, "is a project", "give it as the only input");
    if (options.says_what)
        return bad_arguments(*found, "is a project, which says what to show", "leave out the other options");
    LUCARNE_ASSIGN(const Project project, read_project(*found, std::nullopt));
    const std::filesystem::path file = absolute_path(*found);
    const FoundScans scans = find_scans(project.scans, file.parent_path());
    if (scans.found.empty() && scans.missing.empty()) return rejected(*found, "names no scan");
    if (scans.found.empty() && !options.screenshot.empty())
        return rejected(*found, "none of its scans was found", "put them beside it");
    options.project = *found;
    paths.clear();
    return {};
}

ViewModel first_model(const ViewOptions& options, const Drawing& drawing) {
    ViewModel model(1.0);
    model.view.method = {options.drawing.render.engine, drawing.preset.engine, drawing.preset.budgets};
    model.view.resolution_scale = options.drawing.render.scale.value_or(1);
    model.view.preset = drawing.preset.name;
    model.view.frame_time = options.frame_time_ms * 1e-3;
    model.view.caps = drawing.caps;
    model.scene_file.set_path(options.drawing.scene);
    if (!options.project.empty()) model.commands.push(OpenProject{options.project});
    if (options.drawing.scene.empty())  // the background until there is a picture
        set_mood(model.view.scene, Mood::scan_colours, {}, {});
    if (!options.measurements.empty()) {
        model.measure.file = options.measurements;
        model.measure.commands.push(LoadMeasurements{});
    }
    if (!options.path.empty()) {
        model.publish.path_file = options.path;
        model.publish.commands.push(LoadPath{});
    }
    return model;
}

void take_settings(Settings settings, ViewModel& model) {
    if (const auto mode = navigation_mode(settings.navigation)) model.view.navigation.set_mode(*mode);
    model.view.side_bar = settings.side_bar;
    model.settings = std::move(settings);
}

Result<void> view(ViewOptions options) {
    LUCARNE_TRY(take_project(options));
    LUCARNE_TRY(take_render_settings(options.drawing));
    LUCARNE_ASSIGN(Drawing drawing, resolve(options.drawing));
    LUCARNE_TRY(check_scene(options));
    if (!options.measurements.empty()) LUCARNE_TRY(load_measurements(options.measurements, std::nullopt));
    if (!options.path.empty()) LUCARNE_TRY(load_path(options.path));
    std::optional<ScriptedShot> shot;
    if (!options.screenshot.empty()) {
        auto inputs = options.input.paths;
        inputs.insert(inputs.end(), {options.measurements, options.path, options.drawing.scene});
        LUCARNE_TRY(check_outputs({options.screenshot}, options.overwrite, inputs));
        shot = ScriptedShot{options.screenshot, options.frames, options.overwrite};
    }
    InterruptRequest interrupt;
    std::atomic<bool> awake{false};
    ScanSet scans(
        options.input, [&](const octree::NodeSource& source) { return starting_view(options, source); },
        [&] {
            if (awake) Window::wake();
        });
    scans.open(options.input.paths, true);  // loads while the window starts
    LoadedSettings kept = load_settings(config_folder());
    if (!kept.problem.empty()) log::warn("{}", kept.problem);
    for (const std::string& path : options.input.paths) kept.settings.opened(absolute_path(path));
    if (options.drawing.device_memory.empty() && kept.settings.device_memory > 0)
        drawing.caps.device_memory = static_cast<uint64_t>(kept.settings.device_memory * (1 << 20));
    const ImageSize size =
        options.size_given || !kept.settings.window.width ? drawing.size : kept.settings.window;
    LUCARNE_ASSIGN(const auto window, Window::open(size, "Lucarne"));
    awake = true;
    LUCARNE_ASSIGN(const auto worker, PictureWorker::start(window->worker_device(Window::Hidden::view),
                                                           nullptr, drawing.caps, &Window::wake));
    ViewModel model = first_model(options, drawing);
    model.view.device = worker->device();
    model.scans = &scans;
    model.view.message = std::move(kept.problem);
    take_settings(std::move(kept.settings), model);
    auto done = ViewSession(*window, *worker, model, shot, scans, interrupt, !options.says_what).run();
    awake = false;
    return done;
}

}  // namespace

void add_view(CommandLine& line) {
    auto options = std::make_shared<ViewOptions>();
    Arguments command = line.add("view", "Explore caches and scans lit by their own surfaces");
    options->input.required = false;
    add_drawing_options(command, options->drawing);
    add_input_options(command, options->input);
    command.add("--camera", options->camera, "Start with this camera of the scene");
    command
        .add("--scale", options->drawing.render.scale,
             "Render pictures at this share of the window's width and height, and scale them up: 0.5 takes a "
             "quarter of "
             "the pixels' time")
        .range(gi::kLeastPictureScale, 1.0)
        .type_name("X");
    command
        .add("--frame-time", options->frame_time_ms,
             "Target time of a picture while something moves; cuts and size follow it")
        .range(1.0, 1e5)
        .show_default()
        .type_name("MS");
    command.add("--measurements", options->measurements, "Show these measurements, as the window saves them")
        .type_name("FILE.json");
    command.add("--path", options->path, "Show and edit this flythrough").type_name("P.json");
    command.add("--screenshot", options->screenshot,
                "Save the window as this PNG once its picture is complete, and close");
    command.add("--frames", options->frames, "Number of complete pictures to average with --screenshot")
        .range(1u, 256u)
        .show_default();
    command.flag("--overwrite", options->overwrite, "Replace the screenshot's file");
    command.run([options, command] {
        options->size_given = command.given("--size");
        options->says_what = !command.given_only(
            {"INPUT", "--size", "--points", "--memory", "--device-memory", "--no-prefetch", "--no-cache",
             "--frame-time", "--screenshot", "--frames", "--overwrite", "--columns", "--unit", "--up",
             "--spacing", "--mesh-points", "--vertices", "--salvage"});
        return view(*options);
    });
}

}  // namespace lucarne::viewer
