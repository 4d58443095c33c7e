// The accuracy of the engine `volume`, against form factors, furnaces and the reference, beside `vpl`.
#pragma once

#include <string>

#include <fmt/format.h>

#include "tests/bench/accuracy.h"
#include "tests/bench/bench_run.h"
#include "tests/bench/gathered_accuracy.h"
#include "tests/bench/scan.h"
#include "tests/bench/stage.h"

namespace lucarne::bench {

inline Result<void> accuracy_of_volume(gi::Device& device, const BenchRun& run) {
    LUCARNE_TRY(form_factors(device, run, "volume", .02, .02));
    LUCARNE_TRY(furnace(device, run, "volume", .01, .01));
    AccuracyTable table(device, run, "volume");
    LUCARNE_ASSIGN(const Scan box, Scan::create("cornell", run.points(300'000), run.folder));
    for (const int bounce : run.cases<int>({1, 2, 3})) {
        Stage stage(device, box);
        LUCARNE_TRY(stage.open(table.view(scene_file("cornell"))));
        LUCARNE_TRY(table.row(stage, {.name = fmt::format("cornell, scan, bounce {}", bounce),
                                      .only_bounce = bounce,
                                      .frames = {1, 16},
                                      .targets = {{.05, .05}, {.05, .05}}}));
    }
    LUCARNE_ASSIGN(const Scan nave, Scan::create("nave", run.points(300'000), run.folder));
    for (const std::string& camera : run.cases<std::string>({"nave", "carpet", "aisle", "altar", "vault"})) {
        Stage stage(device, nave);
        LUCARNE_TRY(stage.open(table.view(scene_file("nave"), camera)));
        LUCARNE_TRY(
            table.row(stage, {.name = "nave, " + camera + ", bounces 0 to 3", .targets = {{.1, .15}}}));
    }
    return {};
}

}  // namespace lucarne::bench
