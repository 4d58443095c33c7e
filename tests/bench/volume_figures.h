// The experiments of Gaitatzes 2012 on light that is propagated through voxels, chapter 5, repeated on scenes
// of ours that stand in for the thesis', beside the transport by sweeps and the reference.
#pragma once

#include <algorithm>
#include <cstdint>
#include <cstdio>
#include <string>
#include <utility>
#include <vector>

#include <fmt/format.h>

#include "gi/bounce_options.h"
#include "gi/compare/metrics.h"
#include "gi/engines/volume/options.h"
#include "tests/bench/accuracy.h"
#include "tests/bench/bench_run.h"
#include "tests/bench/gathered_figures.h"
#include "tests/bench/scan.h"
#include "tests/bench/stage.h"

namespace lucarne::bench {

/// A scene of ours in the place of one of the thesis' figures.
struct PropagationScene {
    int figure = 53;
    std::string scan, sampling, scene, camera;
    uint32_t iterations = 11;
    std::string thesis;   ///< its row of table 2
    uint32_t levels = 1;  ///< of the row with nested volumes about the camera; 1: there is none
};

/// Prints a row of table 2 for each transport, with the error of one bounce and of the whole picture, and
/// writes the figure's pictures: fig-53-direct.png, fig-53-sh-bounce-1.png, fig-53-sh.png, ...
inline Result<void> row_of_table_2(gi::Device& device, const BenchRun& run, const PropagationScene& scene) {
    using gi::volume::Transport;
    LUCARNE_ASSIGN(const Scan scan,
                   Scan::create(scene.scan, run.points(500'000), run.folder, scene.sampling));
    Stage stage(device, scan);
    LUCARNE_TRY(stage.open({.scene = scene_file(scene.scene),
                            .size = run.size({512, 512}),
                            .preset = run.trial() ? "preview" : "interactive",
                            .camera = scene.camera}));
    const auto write = [&](const std::string& name) {
        return stage.write(run.folder / fmt::format("fig-{}-{}.png", scene.figure, name));
    };
    gi::EngineSettings whole = stage.settings();
    whole.set(gi::kBounces, 1);
    whole.set(gi::volume::kVoxelCount, 32);
    whole.set(gi::volume::kIterations, scene.iterations);
    gi::EngineSettings bounce = whole;
    bounce.set(gi::kOnlyBounce, 1);
    const uint64_t paths = std::max<uint64_t>(run.count(64), 2);
    LUCARNE_ASSIGN(const Scan::Truth whole_truth, stage.truth(whole, paths));
    LUCARNE_TRY(write("reference"));
    LUCARNE_ASSIGN(const Scan::Truth bounce_truth, stage.truth(bounce, paths));
    LUCARNE_TRY(write("reference-bounce-1"));
    struct Way {
        std::string name;
        Transport transport;
        uint32_t levels;
    };
    std::vector<Way> ways = {{"sh", Transport::sh, 1}, {"sweeps", Transport::sweeps, 1}};
    if (scene.levels > 1)
        ways.push_back({fmt::format("{} levels", scene.levels), Transport::sweeps, scene.levels});
    for (const auto& [name, transport, levels] : ways) {
        for (gi::EngineSettings* settings : {&whole, &bounce}) {
            settings->set(gi::volume::kTransport, transport);
            settings->set(gi::volume::kVolumeLevels, levels);
        }
        LUCARNE_TRY(stage.picture("direct", whole));  // so that the engine is made anew
        LUCARNE_TRY(write("direct"));
        LUCARNE_ASSIGN(const Stage::Picture picture, stage.picture("volume", whole));
        LUCARNE_TRY(write(name));
        LUCARNE_ASSIGN(const auto error,
                       gi::compare_with_halves(picture.pixels, whole_truth.first, whole_truth.second));
        const viewer::FrameStats steps = picture.last;
        LUCARNE_ASSIGN(const Stage::Picture only, stage.picture("volume", bounce));
        LUCARNE_TRY(write(name + "-bounce-1"));
        const auto ms = [&](const char* pass) { return 1e3 * pass_seconds(steps, pass); };
        const double indirect = gi::mean_luminance(bounce_truth.whole);
        fmt::print("{:<12} {:>9.0f} {:>9} {:>10} {:>8.0f} {:>11.0f} {:>9.0f} {:>9.0f} {:>9.1f} {:>9.3f}\n",
                   scene.scene, statistic(steps, "occupied_voxels"), name,
                   transport == Transport::sh ? std::to_string(scene.iterations) : "-",
                   ms("voxels") + ms("faces"), ms("propagation") + ms("first bounce") + ms("sweep"),
                   ms("light of the volume"), 1e3 * picture.seconds,
                   100 * (gi::mean_luminance(only.pixels) / std::max(indirect, 1e-12) - 1), error.rel_mse);
        std::fflush(stdout);
    }
    fmt::print("  the thesis: {}\n", scene.thesis);
    return {};
}

/// Prints what far plates receive, over what they ought to, by iterations and by sweeps; 32 voxels, which is
/// 26 from plate to plate. Finding: two bands of harmonics forget directions.
inline Result<void> far_light(gi::Device& device, const BenchRun& run) {
    heading("light that crosses the room: error of what a unit square receives of a parallel one, 32 voxels");
    const glm::vec3 x(1, 0, 0), y(0, 1, 0), z(0, 0, 1);
    gi::EngineSettings settings;
    settings.set(gi::volume::kVoxelCount, 32);
    for (const uint32_t iterations : run.cases<uint32_t>({64, 512})) {
        settings.set(gi::volume::kTransport, gi::volume::Transport::sh);
        settings.set(gi::volume::kIterations, iterations);
        for (const float distance : {.5f, 1.0f})
            LUCARNE_TRY(form_factor(device, run, "volume",
                                    fmt::format("at {}, sh, {} iterations", distance, iterations),
                                    distance * z, y, x, 0, 0, settings));
    }
    settings.set(gi::volume::kTransport, gi::volume::Transport::sweeps);
    for (const float distance : {.5f, 1.0f})
        LUCARNE_TRY(form_factor(device, run, "volume", fmt::format("at {}, sweeps", distance), distance * z,
                                y, x, 0, 0, settings));
    return {};
}

inline Result<void> figures_of_chapter_5(gi::Device& device, const BenchRun& run) {
    heading(
        "table 2 and figs 53 to 57: one bounce, 512x512, 32 voxels, ms; energy of bounce 1 and relMSE of the "
        "picture against the reference (the thesis, GTX 285: ms of voxelization, propagation, all)");
    fmt::print("{:<12} {:>9} {:>9} {:>10} {:>8} {:>11} {:>9} {:>9} {:>9} {:>9}\n", "scene", "occupied", "by",
               "iterations", "voxels", "propagation", "pixels", "all", "energy %", "relMSE");
    for (const PropagationScene& scene : run.cases<PropagationScene>(
             {{53, "cornell", "--even --normals", "cornell", "", 11, "test scene, 48 triangles: 10, 12, 22"},
              {54, "house", "", "house", "daylight", 64, "room, 704 triangles: 3, 61, 69"},
              {55, "nave", "--even --normals", "nave", "", 11, "Sponza, 66454 triangles: 10, 11, 28"},
              {56, "survey", "", "survey-sky", "street", 12, "arena, 10219 triangles: 3, 13, 21", 4}}))
        LUCARNE_TRY(row_of_table_2(device, run, scene));
    return far_light(device, run);
}

}  // namespace lucarne::bench
