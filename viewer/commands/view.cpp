#include <algorithm>
#include <future>
#include <memory>
#include <string>
#include <vector>

#include <CLI/CLI.hpp>
#include <glm/geometric.hpp>

#include "io/core/file.h"
#include "octree/bulk.h"
#include "viewer/commands/commands.h"
#include "viewer/commands/drawing_options.h"
#include "viewer/input.h"
#include "viewer/inputs.h"
#include "viewer/view_session.h"

namespace lucarne::viewer {
namespace {

struct ViewOptions {
    InputOptions input;
    std::string camera, screenshot;
    DrawingOptions drawing;
    uint32_t frames = 1;
    double frame_time_ms = 100;
    bool overwrite = false;
};

Result<StartingView> starting_view(const ViewOptions& options, const octree::NodeSource& source) {
    StartingView start;
    LUCARNE_ASSIGN(start.scene, load_scene_for(options.drawing, source));
    LUCARNE_ASSIGN(start.camera, find_camera(start.scene, options.camera));
    return start;
}

Result<ViewModel> first_model(const ViewOptions& options, const Drawing& drawing,
                              const octree::NodeSource& source) {
    const auto [low, high] = octree::bulk_of(source);
    ViewModel model(std::max(glm::distance(low, high), 1e-6));
    LUCARNE_ASSIGN(StartingView start, starting_view(options, source));
    model.scene = std::move(start.scene);
    model.home = start.camera;
    model.rig = CameraRig(model.home);
    model.engine = options.drawing.engine;
    model.preset = drawing.preset.name;
    model.settings = drawing.preset.engine;
    model.budgets = drawing.preset.budgets;
    model.frame_time = options.frame_time_ms * 1e-3;
    model.caps = drawing.caps;
    return model;
}

Result<void> view(const ViewOptions& options) {
    LUCARNE_ASSIGN(const Drawing drawing, resolve(options.drawing));
    std::optional<ScriptedShot> shot;
    if (!options.screenshot.empty()) {
        LUCARNE_TRY(check_output(options.screenshot, options.overwrite));
        shot = ScriptedShot{options.screenshot, options.frames, options.overwrite};
    }
    const std::string title = "Lucarne - " + inputs_text(options.input.paths);
    auto opening = std::async(std::launch::async, [&] { return open_growing(options.input); });
    LUCARNE_ASSIGN(const auto window,
                   Window::open(drawing.size, title));  // starts while the input is looked at
    LUCARNE_ASSIGN(const OpenInput input, opening.get());
    LUCARNE_ASSIGN(ViewModel model, first_model(options, drawing, *input.source));
    LUCARNE_ASSIGN(const auto worker,
                   PictureWorker::start(window->worker_device(), input.source, drawing.caps, &Window::wake));
    model.device = worker->device();
    const auto start = [&](const octree::NodeSource& source) { return starting_view(options, source); };
    return ViewSession(*window, *worker, model, shot, {title, input.source, input.build.get(), start}).run();
}

}  // namespace

void add_view(CLI::App& app, Command& chosen) {
    auto options = std::make_shared<ViewOptions>();
    auto* command = app.add_subcommand("view", "Look around in a cache or a scan, lit by its own surfaces");
    add_input_options(*command, options->input);
    add_drawing_options(*command, options->drawing);
    command->add_option("--camera", options->camera, "Start with this camera of the scene");
    command
        ->add_option("--frame-time", options->frame_time_ms,
                     "What a picture should take while something moves; cuts and size follow it")
        ->check(CLI::Range(1.0, 1e5))
        ->capture_default_str()
        ->type_name("MS");
    command->add_option("--screenshot", options->screenshot,
                        "Save the window as this PNG once it is whole, and close");
    command->add_option("--frames", options->frames, "Whole pictures to wait for with --screenshot")
        ->check(CLI::Range(1u, 256u))
        ->capture_default_str();
    command->add_flag("--overwrite", options->overwrite, "Replace the screenshot's file");
    command->callback([options, &chosen] { chosen = [options] { return view(*options); }; });
}

}  // namespace lucarne::viewer
