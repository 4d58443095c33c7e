// The accuracy of the engine `paths` against the reference and beside `vpl`.
#pragma once

#include <string>
#include <utility>

#include "tests/bench/gathered_accuracy.h"

namespace lucarne::bench {

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
                                      .targets = {{camera == "altar" ? .04 : .02, .03}}}));
    }
    Stage stage(device, nave);
    LUCARNE_TRY(stage.open(table.view(scene_file("nave-sky"), "nave")));
    return table.row(stage, {.name = "nave-sky, bounce 1", .only_bounce = 1, .targets = {{.02, .05}}});
}

}  // namespace lucarne::bench
