#include <memory>
#include <string>

#include <fmt/format.h>

#include "io/core/counted.h"
#include "io/core/log.h"
#include "io/core/options.h"
#include "io/core/progress.h"
#include "io/formats/scan.h"
#include "io/synthetic/scene_geometry.h"
#include "io/synthetic/surface_mesh.h"
#include "io/synthetic/synthetic.h"
#include "viewer/commands/commands.h"
#include "viewer/commands/options/outputs.h"

namespace lucarne::viewer {
namespace {

constexpr size_t kBatchPoints = 1 << 17;
constexpr double kLeastMeshStep = .01, kLargestMeshStep = 100;  ///< metres; the nave has 2^26 vertices at .01

struct GenerateOptions {
    io::SyntheticOptions scan;
    std::string points = "1M", output, mesh;
    double mesh_step = io::kMeshStep;
    bool overwrite = false;
};

Result<void> write_mesh(const GenerateOptions& options) {
    if (options.scan.scene == io::synthetic_survey().name)
        return bad_arguments(fmt::format("scene '{}'", options.scan.scene), "has no true surface",
                             "choose another scene for --mesh");
    LUCARNE_ASSIGN(const auto geometry, io::SceneGeometry::create(options.scan.scene));
    const io::SurfaceMesh mesh = io::surface_mesh(geometry->mesh(), options.mesh_step);
    LUCARNE_TRY(io::write_surface_mesh(mesh, options.mesh, options.overwrite));
    log::info("{}: the surface of {}, {}, {:.1f} m2", options.mesh, options.scan.scene,
              counted(mesh.triangles.size(), "triangles"), geometry->area());
    return {};
}

Result<void> write_scan(GenerateOptions options) {
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

Result<void> generate(const GenerateOptions& options) {
    if (options.output.empty() && options.mesh.empty())
        return bad_arguments("generate", "there is nothing to write", "give --output, --mesh or both");
    LUCARNE_TRY(check_outputs({options.output, options.mesh}, options.overwrite, {}));
    if (!options.mesh.empty()) LUCARNE_TRY(write_mesh(options));
    if (!options.output.empty()) LUCARNE_TRY(write_scan(options));
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
    command.add("-o,--output", options->output, "The scan to write: .las, .laz or .ply").type_name("FILE");
    command
        .add("--mesh", options->mesh,
             "Write the true surface as binary PLY: triangles with normals and albedo (sRGB); without "
             "--output write no scan")
        .type_name("FILE.ply");
    command
        .add("--mesh-step", options->mesh_step,
             "Largest side of the mesh's cells where the albedo varies, metres")
        .range(kLeastMeshStep, kLargestMeshStep)
        .show_default()
        .type_name("M");
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
