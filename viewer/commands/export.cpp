#include "octree/export/export.h"

#include <algorithm>
#include <filesystem>
#include <memory>
#include <optional>

#include <fmt/format.h>

#include "gi/scene/scene.h"
#include "io/core/counted.h"
#include "io/core/log.h"
#include "io/core/options.h"
#include "io/core/progress.h"
#include "octree/open.h"
#include "viewer/commands/commands.h"
#include "viewer/commands/options/clip_options.h"
#include "viewer/commands/options/outputs.h"
#include "viewer/publish/seen_points.h"

namespace lucarne::viewer {
namespace {

struct Options {
    std::filesystem::path cache, output;
    std::string scene;
    ClipOptions clip;
    std::vector<int> hidden_classes, kept_classes;
    octree::ExportOptions content;
    double spacing = 0, precision = 0;  ///< metres
    bool overwrite = false;
};

constexpr double kFine = 9e-5;  ///< m: finer than what scanners measure

Result<void> check_attributes(const std::vector<std::string>& wanted, const io::Schema& schema) {
    std::vector<std::string_view> names;
    for (const io::Attribute& attribute : schema.attributes) names.push_back(attribute.name);
    for (const std::string& name : wanted)
        if (std::ranges::find(names, name) == names.end())
            return bad_arguments("--attributes", fmt::format("the points have no attribute '{}'", name),
                                 names.empty() ? "they have only positions" : advice(name, names));
    return {};
}

/// Returns the clip and the classes of the scene, with those of the options.
Result<gi::Look> seen(const Options& options) {
    gi::Look look;
    if (!options.scene.empty()) {
        LUCARNE_ASSIGN(const gi::Scene scene, gi::load_scene(options.scene));
        look = scene.look;
    }
    LUCARNE_TRY(apply(options.clip, look.clip));
    if (!options.kept_classes.empty()) {
        look.hidden_classes.set();
        for (const int number : options.kept_classes) look.hidden_classes.reset(static_cast<size_t>(number));
    }
    for (const int number : options.hidden_classes) look.hidden_classes.set(static_cast<size_t>(number));
    return look;
}

Result<void> export_cache(const Options& options) {
    LUCARNE_TRY(
        check_outputs({options.output.string()}, options.overwrite, {options.cache.string(), options.scene}));
    LUCARNE_ASSIGN(const gi::Look look, seen(options));
    LUCARNE_ASSIGN(const auto source, octree::open_octree(options.cache));
    const octree::SourceHeader& header = source->header();
    octree::ExportOptions content = options.content;
    if (!content.attributes.empty()) {
        content.attributes.clear();
        const octree::Exporter all(*source, content);
        content.attributes = options.content.attributes;
        LUCARNE_TRY(check_attributes(content.attributes, all.schema()));
    }
    content.spacing = options.spacing / header.metres_per_unit;
    content.precision = options.precision / header.metres_per_unit;
    if (content.precision > 0) LUCARNE_TRY(octree::check_precision(header, content.precision));
    export_what_is_seen(look, header.schema, content);
    const octree::Exporter exporter(*source, content);
    std::optional<Progress> progress;  // none before an error
    LUCARNE_ASSIGN(const uint64_t written,
                   write_points(exporter, options.output, options.overwrite, [&](uint64_t done) {
                       if (!progress) progress.emplace("exporting", header.points, "points");
                       progress->add(done);
                   }));
    progress.reset();
    if (content.all_points())
        log::info("{}: {}", options.output.string(), counted(written, "points"));
    else
        log::info("{}: {} of {}", options.output.string(), written, counted(header.points, "points"));
    const double finest = exporter.schema().scale.x * header.metres_per_unit;
    if (exporter.schema().position == io::PositionType::i32_scaled && finest < kFine &&
        options.output.extension() == ".laz")
        log::info("positions are kept to {:.0e} m; --precision 0.001 makes a smaller file", finest);
    if (written == 0 && header.points > 0)
        log::warn("{}: no point was left by the clips, classes and spacing", options.output.string());
    return {};
}

}  // namespace

void add_export(CommandLine& line) {
    auto options = std::make_shared<Options>();
    Arguments command =
        line.add("export", "Write a cache, or a part of it, back to a scan file, with every attribute");
    command.add("cache", options->cache, "The cache (or COPC file) to read").required().type_name("CACHE");
    command
        .add("-o,--output", options->output,
             "The scan to write: .las, .laz, .copc.laz, .ply, .pcd, .csv, .txt or .xyz")
        .required()
        .type_name("FILE");
    command.add("--scene", options->scene, "Write only what this scene's clips and hidden classes leave")
        .type_name("FILE");
    add_clip_options(command, options->clip);
    command.add("--hide-class", options->hidden_classes, "Leave out these classes")
        .range(0, 255)
        .separator(',')
        .type_name("N,...");
    command.add("--keep-class", options->kept_classes, "Write only these classes")
        .range(0, 255)
        .separator(',')
        .type_name("N,...");
    command
        .add("--spacing", options->spacing,
             "Write points about so far apart, metres; which ones, the octree has chosen")
        .range(0.0, 1e6)
        .type_name("M");
    command
        .add("--precision", options->precision,
             "Round positions to multiples of this, metres: smaller LAZ files where scans keep finer digits")
        .range(0.0, 1e3)
        .type_name("M");
    command.add("--every", options->content.every, "Write every N-th point of those that are left")
        .range(uint64_t{1}, uint64_t{1'000'000'000})
        .type_name("N");
    command
        .add("--attributes", options->content.attributes,
             "Write only these attributes beside positions, by name as in `lucarne info`")
        .separator(',')
        .type_name("NAME,...");
    command.flag(
        "--normals", options->content.normals,
        "Also write estimated normals, as normal (always done if convert ran with --normals estimate)");
    command.flag("--overwrite", options->overwrite, "Replace the output if it exists");
    command.run([options] { return export_cache(*options); });
}

}  // namespace lucarne::viewer
