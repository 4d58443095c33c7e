// The accuracy of the engine `volume`, against form factors, furnaces and the reference, beside `vpl`.
#pragma once

#include <string>

#include <fmt/format.h>

#include "gi/engines/volume/options.h"
#include "tests/bench/accuracy.h"
#include "tests/bench/bench_run.h"
#include "tests/bench/gathered_accuracy.h"
#include "tests/bench/scan.h"
#include "tests/bench/stage.h"

namespace lucarne::bench {

inline Result<void> accuracy_of_volume(gi::Device& device, const BenchRun& run) {
    LUCARNE_TRY(form_factors(device, run, "volume", .02, .02));
    // The thesis' transport as it is, at its own size: a row without a target.
    gi::EngineSettings sh;
    sh.set(gi::volume::kTransport, gi::volume::Transport::sh);
    sh.set(gi::volume::kVoxelCount, 32);
    sh.set(gi::volume::kIterations, 64);
    const glm::vec3 x(1, 0, 0), y(0, 1, 0), z(0, 0, 1);
    LUCARNE_TRY(form_factor(device, run, "volume", "parallel at 1, sh", z, y, x, 0, 0, sh));
    LUCARNE_TRY(form_factor(device, run, "volume", "parallel at .5, sh", .5f * z, y, x, 0, 0, sh));
    LUCARNE_TRY(furnace(device, run, "volume", .01, .01));
    AccuracyTable table(device, run, "volume");
    LUCARNE_ASSIGN(const Scan box, Scan::create("cornell", run.points(300'000), run.folder));
    for (const int bounce : run.cases<int>({1, 2, 3})) {
        Stage stage(device, box);
        LUCARNE_TRY(stage.open(table.view(scene_file("cornell"))));
        LUCARNE_TRY(table.row(stage, {.name = fmt::format("cornell, scan, bounce {}", bounce),
                                      .only_bounce = bounce,
                                      .frames = {1, 16},
                                      .targets = {{.05, 0, .05}, {.05, 0, .05}}}));
    }
    LUCARNE_ASSIGN(const Scan nave, Scan::create("nave", run.points(300'000), run.folder));
    for (const std::string& camera : run.cases<std::string>({"nave", "carpet", "aisle", "altar", "vault"})) {
        Stage stage(device, nave);
        LUCARNE_TRY(stage.open(table.view(scene_file("nave"), camera)));
        LUCARNE_TRY(
            table.row(stage, {.name = "nave, " + camera + ", bounces 0 to 3", .targets = {{.1, 0, .15}}}));
    }
    return {};
}

}  // namespace lucarne::bench
