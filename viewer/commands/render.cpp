#include <algorithm>
#include <cmath>
#include <filesystem>
#include <future>
#include <memory>
#include <optional>
#include <string>
#include <vector>

#include <fmt/format.h>
#include <nlohmann/json.hpp>

#include "gi/compare/edges.h"
#include "gi/compare/metrics.h"
#include "gi/registry.h"
#include "io/core/log.h"
#include "io/core/process.h"
#include "io/core/progress.h"
#include "io/files/file.h"
#include "io/files/json.h"
#include "io/image/image.h"
#include "viewer/commands/commands.h"
#include "viewer/commands/options/drawing_options.h"
#include "viewer/commands/options/input_options.h"
#include "viewer/commands/options/outputs.h"
#include "viewer/inputs/input.h"
#include "viewer/opening/first_view.h"
#include "viewer/publish/finished_picture.h"

namespace lucarne::viewer {
namespace {

struct RenderOptions {
    InputOptions input;
    std::string output, camera, json, gbuffer;
    DrawingOptions drawing;
    uint32_t frames = 1;
    double seconds = 0;
    PictureFinish finish;
    bool first = false, layers = false, no_overlay = false, aliased = false, overwrite = false;
};

enum class PictureKind { png, exr };

Result<PictureKind> picture_kind(const std::string& path) {
    std::string extension = std::filesystem::path(path).extension().string();
    std::transform(extension.begin(), extension.end(), extension.begin(),
                   [](unsigned char c) { return std::tolower(c); });
    if (extension == ".png") return PictureKind::png;
    if (extension == ".exr") return PictureKind::exr;
    return bad_arguments("--output", fmt::format("'{}' has an unsupported picture format", path),
                         "use .png or .exr");
}

/// The result of all frames together.
struct Rendered {
    FrameStats last;
    uint32_t frames = 0;
    double seconds = 0;
    double variance = 0;  ///< variance of the mean luminance, if the engine estimates its noise
    io::Image gbuffer;    ///< of the first frame, whose rays pass through the middles of the pixels
};

double engine_stat(const FrameStats& stats, std::string_view name) {
    for (const auto& [key, value] : stats.engine)
        if (key == name) return value;
    return 0;
}

/// Renders and averages at least `frames` frames for at least `seconds`.
Result<Rendered> render_frames(Pipeline& pipeline, FrameRequest request, const RenderOptions& options) {
    Rendered rendered;
    std::optional<Progress> progress;
    if (pipeline.engine().reports_progress) {
        const uint64_t pixels = uint64_t{request.size.width} * request.size.height;
        progress.emplace(std::string(pipeline.engine().name),
                         options.seconds > 0 ? 0 : pixels * options.frames, "pixels");
        request.progress = &*progress;
    }
    while (rendered.frames < options.frames || rendered.seconds < options.seconds) {
        LUCARNE_ASSIGN(rendered.last, pipeline.render(request));
        if (!options.gbuffer.empty() && rendered.frames == 0)
            rendered.gbuffer = gi::gbuffer_image(pipeline.gbuffer());
        const double error = engine_stat(rendered.last, "standard error");
        rendered.variance += error * error;
        rendered.seconds += rendered.last.seconds;
        ++rendered.frames;
    }
    rendered.variance /= static_cast<double>(rendered.frames) * rendered.frames;
    return rendered;
}

nlohmann::json report(const Rendered& rendered, const Pipeline& pipeline, const Drawing& drawing,
                      double mean) {
    const FrameStats& stats = rendered.last;
    nlohmann::json passes = nlohmann::json::array(), engine = nlohmann::json::object();
    for (const auto& pass : stats.passes) passes.push_back({{"name", pass.name}, {"seconds", pass.seconds}});
    for (const auto& [name, value] : stats.engine) engine[name] = value;
    return {{"engine", std::string(pipeline.engine().name)},
            {"preset", std::string(drawing.preset.name)},
            {"size", {drawing.size.width, drawing.size.height}},
            {"frames", rendered.frames},
            {"seconds", rendered.seconds},
            {"last_frame_seconds", stats.seconds},
            {"passes", passes},
            {"points",
             {{"view", stats.view_points},
              {"light_view", stats.light_view_points},
              {"light", stats.light_points}}},
            {"cut_complete", stats.complete()},
            {"cut_share", stats.cut_share},
            {"bytes_loaded", stats.bytes_loaded},
            {"memory", {{"cap", pipeline.options().memory}, {"used", stats.memory.host}}},
            {"device_memory", {{"cap", pipeline.options().device_memory}, {"used", stats.memory.device}}},
            {"resident_memory", stats.memory.resident},
            {"exposure_ev", pipeline.exposure_ev()},
            {"mean_luminance", mean},
            {"standard_error", std::sqrt(rendered.variance)},
            {"statistics", engine}};
}

Result<void> write_picture(const RenderOptions& options, PictureKind kind, const Pipeline& pipeline,
                           const gi::SceneCamera& camera, io::Image radiance) {
    if (kind == PictureKind::png)
        return io::write_png(options.output, finished_picture(pipeline, camera, options.finish),
                             options.overwrite);
    if (options.finish.transparent) radiance.pixels = transparent_radiance(pipeline);
    return io::write_exr(options.output, radiance, options.overwrite, options.finish.transparent);
}

/// Returns the file names of the engine's further pictures: OUT.stderr.exr is written beside OUT.exr.
std::vector<std::string> layer_paths(const std::string& output, const gi::EngineInfo& engine) {
    std::vector<std::string> paths;
    for (const std::string_view layer : engine.layers)
        paths.push_back(
            std::filesystem::path(output).replace_extension(fmt::format("{}.exr", layer)).string());
    return paths;
}

/// Returns the files that the command reads.
std::vector<std::string> inputs_of(const RenderOptions& options) {
    auto inputs = options.input.paths;
    inputs.push_back(options.drawing.scene);
    return inputs;
}

/// Checks before long work that the layers can be written.
Result<void> check_layers(const RenderOptions& options) {
    LUCARNE_ASSIGN(const auto engine, gi::find_engine(options.drawing.render.engine));
    if (engine->info.layers.empty())
        return bad_arguments("--layers", fmt::format("engine {} has none", options.drawing.render.engine));
    return check_outputs(layer_paths(options.output, engine->info), options.overwrite, inputs_of(options));
}

/// Describes how finely the picture shows the surfaces. `compare` warns if two pictures differ in it.
std::string surfaces_text(const CutBudgets& budgets) {
    return fmt::format("points {} pixels apart, at most {}", budgets.pixel_spacing, budgets.view);
}

Result<void> write_layers(const RenderOptions& options, const Pipeline& pipeline, const Drawing& drawing) {
    const auto paths = layer_paths(options.output, pipeline.engine());
    auto layers = pipeline.layers();
    for (size_t i = 0; i < layers.size(); ++i)
        LUCARNE_TRY(io::write_exr(paths[i],
                                  {drawing.size.width, drawing.size.height, std::move(layers[i]),
                                   surfaces_text(drawing.preset.budgets)},
                                  options.overwrite));
    return {};
}

std::string fit_text(const FrameStats& stats) {
    const double share = stats.cut_share * stats.complete();
    return share < 1 ? fmt::format("; {:.0f} % of the cuts' points fit the caps", 100 * share) : "";
}

struct Opened {
    std::shared_ptr<const octree::NodeSource> source;
    bool sample = false;  ///< not all points
};

/// Opens the input. With --first opens only what can be drawn at once.
Result<Opened> open_source(const RenderOptions& options) {
    if (!options.first) {
        LUCARNE_ASSIGN(auto source, open_input(options.input));
        return Opened{std::move(source)};
    }
    Opening opening;
    opening.first_points = 200'000;
    opening.first_read = 1'000'000;
    LUCARNE_ASSIGN(const auto open, open_growing(options.input, opening));
    return Opened{open.source, open.build != nullptr};
}

Result<void> render(RenderOptions options) {
    // Check all arguments before any long work.
    LUCARNE_ASSIGN(const PictureKind kind, picture_kind(options.output));
    LUCARNE_TRY(check_outputs({options.output, options.json, options.gbuffer}, options.overwrite,
                              inputs_of(options)));
    LUCARNE_TRY(take_render_settings(options.drawing));
    LUCARNE_ASSIGN(const Drawing drawing, resolve(options.drawing));
    if (options.layers) LUCARNE_TRY(check_layers(options));
    auto opening = std::async(std::launch::async, [&] { return open_source(options); });
    LUCARNE_ASSIGN(const auto device, gi::Device::headless());  // starts while the input is checked
    LUCARNE_ASSIGN(const Opened opened, opening.get());
    const auto& source = opened.source;
    LUCARNE_ASSIGN(SceneForScan loaded, load_scene_for(options.drawing, *source));
    options.drawing.render.engine = loaded.engine;
    FrameRequest request;
    LUCARNE_ASSIGN(request.camera, find_camera(loaded.scene, options.camera));
    request.front_only = loaded.site && looks_in_from_outside(*loaded.site, request.camera);
    request.size = drawing.size;
    request.wait = true;
    request.accumulate = options.frames > 1 || options.seconds > 0;
    request.transparent = options.finish.transparent;
    request.antialiased = !options.aliased;
    if (opened.sample) request.most_pixels = kSketchDots;

    LUCARNE_ASSIGN(const auto pipeline,
                   open_pipeline(*device, source, options.drawing, drawing, loaded.scene));
    LUCARNE_ASSIGN(const Rendered rendered, render_frames(*pipeline, request, options));
    const size_t pixels = size_t{drawing.size.width} * drawing.size.height;
    io::Image picture{drawing.size.width, drawing.size.height,
                      pipeline->radiance().download_all<glm::vec4>(pixels),
                      surfaces_text(drawing.preset.budgets)};
    const double mean = gi::mean_luminance(picture.pixels);
    LUCARNE_TRY(write_picture(options, kind, *pipeline, request.camera, std::move(picture)));
    if (!options.gbuffer.empty())
        LUCARNE_TRY(io::write_exr(options.gbuffer, rendered.gbuffer, options.overwrite, true));
    if (options.layers) LUCARNE_TRY(write_layers(options, *pipeline, drawing));
    if (!options.json.empty()) {
        LUCARNE_TRY(write_file(options.json, json_text(report(rendered, *pipeline, drawing, mean)),
                               options.overwrite));
    }
    log::info("{}: {}x{}, {}, preset {}, {} frame{} in {:.2f} s; {}{}", options.output, drawing.size.width,
              drawing.size.height, pipeline->engine().name, drawing.preset.name, rendered.frames,
              rendered.frames == 1 ? "" : "s", rendered.seconds,
              memory_text(drawing.caps, rendered.last.memory), fit_text(rendered.last));
    if (const std::string chosen = chosen_text(loaded); !chosen.empty()) log::info("{}", chosen);
    if (options.first) log::info("first picture after {:.2f} s", seconds_since_start());
    return {};
}

}  // namespace

void add_render(CommandLine& line) {
    auto options = std::make_shared<RenderOptions>();
    Arguments command = line.add("render", "Render one picture without a window");
    command.flag("--first", options->first,
                 "For scans without a cache: render at once from a sample of the points; "
                 "nothing is converted or kept");
    command.add("-o,--output", options->output, "The picture: .png, or .exr for linear radiance")
        .required()
        .type_name("FILE");
    command.add("--camera", options->camera, "A camera of the scene; by default the first").type_name("NAME");
    add_drawing_options(command, options->drawing);
    add_input_options(command, options->input);
    command.add("--frames", options->frames, "Number of frames to average")
        .range(1, 1'000'000)
        .type_name("N");
    command.add("--seconds", options->seconds, "Least time to go on averaging, seconds")
        .range(0.0, 1e6)
        .type_name("S");
    command.flag(
        "--no-antialiasing", options->aliased,
        "Show one surface in each pixel of a frame, that in its middle: hard edges, for comparisons");
    command.add("--json", options->json, "Write figures of the picture as JSON").type_name("FILE");
    command
        .add("--gbuffer", options->gbuffer,
             "Write the G-buffer: unit normal (RGB) and depth in metres (A), for compare")
        .type_name("FILE.exr");
    command.flag("--layers", options->layers,
                 "Also write the engine's further pictures beside the picture (reference: "
                 "OUT.stderr.exr, the standard error of each pixel's luminance, and OUT.a.exr and "
                 "OUT.b.exr, each from half of the paths)");
    command.flag(
        "--transparent", options->finish.transparent,
        "Make the picture transparent (opacity 0) where no point is, instead of drawing a background");
    command.flag("--no-overlay", options->no_overlay,
                 "Leave out the legend, axes and scale bar that the scene requests");
    command.flag("--overwrite", options->overwrite, "Replace files that exist");
    command.run([options] {
        options->finish.overlays = !options->no_overlay;
        return render(*options);
    });
}

}  // namespace lucarne::viewer
