#include <memory>
#include <string>

#include <fmt/format.h>

#include "io/core/counted.h"
#include "io/core/log.h"
#include "io/core/options.h"
#include "io/core/progress.h"
#include "io/formats/scan.h"
#include "io/synthetic/synthetic.h"
#include "viewer/commands/commands.h"

namespace lucarne::viewer {
namespace {

constexpr size_t kBatchPoints = 1 << 17;

struct GenerateOptions {
    io::SyntheticOptions scan;
    std::string points = "1M", output;
    bool overwrite = false;
};

Result<void> generate(GenerateOptions options) {
    LUCARNE_ASSIGN(options.scan.points, parse_count("--points", options.points));
    LUCARNE_ASSIGN(const auto source, io::synthetic_source(options.scan));
    const io::WriteOptions write{options.overwrite, options.scan.even ? options.scan.points : 0};
    LUCARNE_ASSIGN(const auto writer,
                   io::create_scan(options.output, source->schema(), source->info(), write));
    LUCARNE_ASSIGN(const auto reader, source->open());
    uint64_t points = 0;
    {
        Progress progress("generating " + options.scan.scene, options.scan.points, "points");
        io::PointBatch batch;
        while (true) {
            LUCARNE_ASSIGN(const size_t count, reader->read(batch, kBatchPoints));
            if (count == 0) break;
            LUCARNE_TRY(writer->write(batch.bytes));
            points += count;
            progress.add(count);
        }
    }
    LUCARNE_TRY(writer->finish());
    const size_t stations = source->info().stations.size();
    const std::string all = counted(points, "points");
    if (stations == 0 && !options.scan.even)
        log::info("{}: {} of {}", options.output, all, options.scan.scene);
    else if (options.scan.even)
        log::info("{}: {} of {}, sampled evenly", options.output, all, options.scan.scene);
    else
        log::info("{}: {} of {} from {}", options.output, all, options.scan.scene,
                  counted(stations, "stations"));
    return {};
}

}  // namespace

void add_generate(CommandLine& line) {
    auto options = std::make_shared<GenerateOptions>();
    Arguments command = line.add("generate", "Make a virtual scan with known truth");
    std::string scenes = "Scenes:";
    for (const auto& scene : io::synthetic_scenes())
        scenes += fmt::format("\n  {:<11}{}", scene.name, scene.summary);
    scenes += fmt::format("\n  {:<11}{}", io::synthetic_survey().name, io::synthetic_survey().summary);
    command.footer(scenes);
    command.add("scene", options->scan.scene, "Which scene, see below").required().type_name("SCENE");
    command.add("-o,--output", options->output, "The scan to write: .las, .laz or .ply")
        .required()
        .type_name("FILE");
    command.add("--points", options->points, "Number of points: approximate, or exact with --even")
        .show_default()
        .type_name("N[k|M|G]");
    const Argument stations = command
                                  .add("--stations", options->scan.stations,
                                       "Number of scanner stations (default: the scene's own)")
                                  .type_name("N");
    command
        .flag("--even", options->scan.even, "Sample all surfaces evenly instead of scanning, without noise")
        .excludes(stations);
    command.add("--noise", options->scan.noise, "Standard deviation of the measured range, metres")
        .show_default()
        .type_name("M");
    command.flag("--normals", options->scan.normals, "Write the true normals");
    command.add("--seed", options->scan.seed, "Seed of the random numbers; the same seed gives the same file")
        .show_default()
        .type_name("S");
    command.flag("--overwrite", options->overwrite, "Replace the output if it exists");
    command.run([options] { return generate(*options); });
}

}  // namespace lucarne::viewer
