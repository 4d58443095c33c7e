#include <memory>
#include <string>

#include <fmt/format.h>
#include <nlohmann/json.hpp>

#include "gi/registry.h"
#include "io/core/log.h"
#include "io/core/progress.h"
#include "io/files/file.h"
#include "io/files/json.h"
#include "viewer/commands/commands.h"
#include "viewer/commands/options/drawing_options.h"
#include "viewer/commands/options/input_options.h"
#include "viewer/commands/options/outputs.h"
#include "viewer/inputs/input.h"

namespace lucarne::viewer {
namespace {

struct PrepareOptions {
    InputOptions input;
    DrawingOptions drawing;
    std::string json;
    bool overwrite = false;
};

Result<void> prepare(PrepareOptions options) {
    LUCARNE_TRY(check_outputs({options.json}, options.overwrite, options.input.paths));
    LUCARNE_TRY(take_render_settings(options.drawing));
    LUCARNE_ASSIGN(const Drawing drawing, resolve(options.drawing));
    LUCARNE_ASSIGN(const auto engine, gi::find_engine(options.drawing.render.engine));
    if (!engine->info.precomputes)
        return bad_arguments("--engine", fmt::format("{} computes nothing in advance", engine->info.name));
    LUCARNE_ASSIGN(const auto device, gi::Device::headless());
    LUCARNE_ASSIGN(const auto source, open_input(options.input));
    LUCARNE_ASSIGN(SceneForScan loaded, load_scene_for(options.drawing, *source));
    LUCARNE_ASSIGN(const auto pipeline,
                   open_pipeline(*device, source, options.drawing, drawing, loaded.scene));
    Progress progress(options.drawing.render.engine, 1000, "thousandths");
    LUCARNE_ASSIGN(const auto file, pipeline->prepare(&progress));
    if (file.empty())
        return failed(options.input.paths.front(), "there is no place to keep what was computed",
                      "convert the scan, or make its folder writable");
    if (!options.json.empty()) {
        const nlohmann::json report = {{"engine", options.drawing.render.engine},
                                       {"file", file.string()},
                                       {"seconds", progress.seconds()}};
        LUCARNE_TRY(write_file(options.json, json_text(report), options.overwrite));
    }
    log::info("{}: {:.1f} s", file.string(), progress.seconds());
    return {};
}

}  // namespace

void add_prepare(CommandLine& line) {
    auto options = std::make_shared<PrepareOptions>();
    Arguments command =
        line.add("prepare", "Compute in advance what an engine needs, and keep it beside the cache");
    add_drawing_options(command, options->drawing);
    add_input_options(command, options->input);
    command.add("--json", options->json, "Write the file's name and the time as JSON").type_name("FILE");
    command.flag("--overwrite", options->overwrite, "Replace the JSON file if it exists");
    command.run([options] { return prepare(*options); });
}

}  // namespace lucarne::viewer
