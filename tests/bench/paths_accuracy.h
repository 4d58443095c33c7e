// The accuracy of the engine `paths` against the reference and beside `vpl`.
#pragma once

#include <string>
#include <utility>

#include "tests/bench/gathered_accuracy.h"

namespace lucarne::bench {

/// Measures the first bounce of sun and sky through windows.
inline Result<void> day_by_paths(AccuracyTable& table, const Scan& scan, const std::string& scene,
                                 const std::string& camera) {
    Stage stage(table.device(), scan);
    LUCARNE_TRY(stage.open(table.view(scene_file(scene), camera)));
    return table.row(stage, {.name = scene + ", bounce 1", .only_bounce = 1, .targets = {{.02, .05}}});
}

/// Measures what lobes reflect of the first bounce. Exponents over 16 have no target: they are narrower than
/// directions are kept (gi/engines/paths/README.md).
inline Result<void> lobes_by_paths(AccuracyTable& table) {
    const BenchRun& run = table.run();
    LUCARNE_ASSIGN(const Scan box, Scan::create("cornell", run.points(300'000), run.folder));
    for (const int exponent : {10, 15, 100}) {
        Stage stage(table.device(), box);
        Stage::View view = table.view(shiny_scene(run, exponent));
        view.size = run.size({64, 40});  // a path tracer hits lobes by chance and needs many paths
        LUCARNE_TRY(stage.open(view));
        LUCARNE_TRY(table.row(stage, {.name = fmt::format("cornell, shininess {}, bounce 1", exponent),
                                      .only_bounce = 1,
                                      .samples = 1024,
                                      .targets = {exponent > 16 ? ErrorTargets{} : ErrorTargets{.03, .05}}}));
    }
    return {};
}

/// Prints the light in a corner that a thin wall at 45 degrees shuts off, beside that in the room (the
/// paper's figure 12 a is of such leaks). Discs leave pores, so the reference has some there as well.
inline Result<void> sealed_corner(const AccuracyTable& table) {
    const BenchRun& run = table.run();
    LUCARNE_ASSIGN(const Scan lattice, Scan::create("lattice", run.points(300'000), run.folder));
    double through_pores = 0;
    for (const std::string engine : {"reference", "paths", "vpl"}) {
        double luminance[2] = {};
        for (const bool corner : {false, true}) {
            Stage stage(table.device(), lattice);
            LUCARNE_TRY(stage.open(table.view(scene_file("lattice"), corner ? "dark-corner" : "board")));
            LUCARNE_ASSIGN(const Stage::Picture picture, stage.picture(engine, stage.settings()));
            luminance[corner ? 1 : 0] = gi::mean_luminance(picture.pixels);
        }
        if (engine == "reference") through_pores = luminance[1];
        fmt::print("{:<38} {:<13} {:.3g} of {:.3g} W/(sr m^2) {}\n",
                   engine == "reference" ? "lattice, the corner that is shut off" : "", engine, luminance[1],
                   luminance[0],
                   engine == "paths" ? target_text(luminance[1], 1.1 * through_pores, 1) : std::string());
        std::fflush(stdout);
    }
    return {};
}

inline Result<void> accuracy_of_paths(gi::Device& device, const BenchRun& run) {
    AccuracyTable table(device, run, "paths");
    LUCARNE_TRY(furnace(device, run, "paths", .005, .005));
    using Sampling = std::pair<std::string, std::string>;
    for (const auto& [name, sampling] :
         run.cases<Sampling>({{"cornell, even", "--even --normals"}, {"cornell, scan", ""}})) {
        LUCARNE_ASSIGN(const Scan scan, Scan::create("cornell", run.points(300'000), run.folder, sampling));
        Stage stage(device, scan);
        LUCARNE_TRY(stage.open(table.view(scene_file("cornell"))));
        for (const int bounce : run.cases<int>({1, 2, 3, 4}))
            LUCARNE_TRY(
                table.row(stage, {.name = fmt::format("{}, bounce {}", name, bounce),
                                  .only_bounce = bounce,
                                  .targets = {bounce == 1 ? ErrorTargets{.01, .005} : ErrorTargets{.01}}}));
    }
    LUCARNE_ASSIGN(const Scan nave, Scan::create("nave", run.points(300'000), run.folder));
    for (const std::string& camera : run.cases<std::string>({"nave", "carpet", "aisle", "altar", "vault"})) {
        Stage stage(device, nave);
        LUCARNE_TRY(stage.open(table.view(scene_file("nave"), camera)));
        LUCARNE_TRY(table.row(stage, {.name = "nave, " + camera + ", bounces 0 to 3",
                                      .targets = {{camera == "altar" ? .04 : .02, 0, .03}}}));
    }
    LUCARNE_TRY(day_by_paths(table, nave, "nave-sky", "nave"));
    if (run.trial()) return {};
    LUCARNE_ASSIGN(const Scan loft, Scan::create("loft", run.points(300'000), run.folder));
    LUCARNE_TRY(day_by_paths(table, loft, "loft-day", "room"));
    LUCARNE_TRY(lobes_by_paths(table));
    return sealed_corner(table);
}

}  // namespace lucarne::bench
