#include "octree/export/export.h"

#include <filesystem>
#include <memory>

#include "io/core/counted.h"
#include "io/core/log.h"
#include "io/core/progress.h"
#include "io/formats/copc/copc.h"
#include "io/formats/scan.h"
#include "octree/open.h"
#include "viewer/commands/commands.h"
#include "viewer/commands/options/outputs.h"

namespace lucarne::viewer {
namespace {

struct Options {
    std::filesystem::path cache, output;
    octree::ExportOptions content;
    bool overwrite = false;
};

Result<void> export_cache(const Options& options) {
    LUCARNE_TRY(check_outputs({options.output.string()}, options.overwrite, {options.cache.string()}));
    LUCARNE_ASSIGN(const auto source, octree::open_octree(options.cache));
    const octree::Exporter exporter(*source, options.content);
    const uint64_t points = source->header().points;
    Progress progress("exporting", points, "points");
    const auto advance = [&](uint64_t done) { progress.add(done); };
    if (io::copc::is_name(options.output)) {
        LUCARNE_TRY(exporter.write_copc(options.output, options.overwrite, advance));
        log::info("{}: {}", options.output.string(), counted(points, "points"));
        return {};
    }
    LUCARNE_ASSIGN(const auto writer, io::create_scan(options.output, exporter.schema(), exporter.info(),
                                                      exporter.write_options(options.overwrite)));
    LUCARNE_TRY(exporter.write(*writer, advance));
    log::info("{}: {}", options.output.string(), counted(points, "points"));
    return {};
}

}  // namespace

void add_export(CommandLine& line) {
    auto options = std::make_shared<Options>();
    Arguments command =
        line.add("export", "Write a cache back to a scan file, with every point and attribute");
    command.add("cache", options->cache, "The cache (or COPC file) to read").required().type_name("CACHE");
    command
        .add("-o,--output", options->output,
             "The scan to write: .las, .laz, .copc.laz, .ply, .pcd, .csv, .txt or .xyz")
        .required()
        .type_name("FILE");
    command.flag(
        "--normals", options->content.normals,
        "Also write estimated normals, as normal (always done if convert ran with --normals estimate)");
    command.flag("--overwrite", options->overwrite, "Replace the output if it exists");
    command.run([options] { return export_cache(*options); });
}

}  // namespace lucarne::viewer
