// The experiments of the paper behind the engine `paths`, Yue et al. 2007, on scenes of ours: table 1 and
// figs 7 and 10 to 14.
#pragma once

#include <cstdint>
#include <cstdio>
#include <string>
#include <utility>
#include <vector>

#include <fmt/format.h>

#include "gi/bounce_options.h"
#include "gi/compare/metrics.h"
#include "gi/engines/paths/options.h"
#include "gi/scene/scene.h"
#include "tests/bench/bench_run.h"
#include "tests/bench/gathered_figures.h"
#include "tests/bench/paths_cells.h"
#include "tests/bench/scan.h"
#include "tests/bench/stage.h"

namespace lucarne::bench {

/// Prints a picture's error, the size of what was computed in advance, and what that took with the picture.
inline Result<void> row_of_paths(Stage& stage, const Scan::Truth& truth, const std::string& name,
                                 const gi::EngineSettings& settings) {
    LUCARNE_ASSIGN(const Stage::Picture picture, stage.picture("paths", settings));
    LUCARNE_ASSIGN(const auto error, gi::compare_with_halves(picture.pixels, truth.first, truth.second));
    const auto stat = [&](const char* of) { return statistic(picture.last, of); };
    fmt::print("{:>22} {:>9.2g} {:>8.1g} {:>9.2f} {:>8.1f} {:>8.0f} {:>9.0f} {:>9.0f} {:>8.0f} {:>8.0f}\n",
               name, error.rel_mse, error.standard_error,
               100 * (gi::mean_luminance(picture.pixels) / gi::mean_luminance(truth.whole) - 1),
               picture.cpu_seconds, stat("gathering_points"), stat("gathering_rays"), stat("entry_points"),
               stat("leaves"), stat("groups"));
    std::fflush(stdout);
    return {};
}

/// Fig. 10, by each option that says how fine the paths are.
inline Result<void> errors_of_paths(Stage& stage, const BenchRun& run, const std::string& what) {
    gi::EngineSettings settings = stage.settings();
    LUCARNE_ASSIGN(const Scan::Truth truth, stage.truth(settings, run.count(256) < 2 ? 2 : run.count(256)));
    heading("fig. 10: " + what +
            ", against the reference (the paper: RMS error 1.3 to 5.7 %; 2k to 39k points, 291k to 8M rays, "
            "426k to 1.4M photons; 1.5 to 2.7 h in advance)");
    fmt::print("{:>22} {:>9} {:>8} {:>9} {:>8} {:>8} {:>9} {:>9} {:>8} {:>8}\n", "", "relMSE", "+-",
               "energy %", "CPU-s", "points", "rays", "entries", "leaves", "groups");
    for (const uint32_t rays : run.cases<uint32_t>({64, 256, 1024})) {
        settings.set(gi::paths::kGatherRays, rays);
        LUCARNE_TRY(row_of_paths(stage, truth, fmt::format("{} rays", rays), settings));
    }
    settings = stage.settings();
    settings.set(gi::paths::kGatherRays, uint32_t{256});
    using gi::paths::Transport;
    for (const uint64_t entries : run.cases<uint64_t>({50'000, 200'000, 800'000})) {
        for (const auto& [name, by] :
             {std::pair("links", Transport::links), {"photons", Transport::photons}}) {
            settings.set(gi::paths::kEntryPoints, entries);
            settings.set(gi::paths::kTransport, by);
            LUCARNE_TRY(row_of_paths(stage, truth, fmt::format("{} entries, {}", entries, name), settings));
        }
    }
    return {};
}

/// Prints the steps of a frame after a change.
inline void row_of_steps(const std::string& name, const Stage::Measured& frame) {
    const auto ms = [&](const char* pass) { return 1e3 * pass_seconds(frame.last, pass); };
    fmt::print("{:>22} {:>8.1f} {:>8.1f} {:>8.1f} {:>8.1f} {:>8.1f} {:>8.1f}\n", name,
               ms("light G-buffer") + ms("direct light"), ms("entry points") + ms("photon energies"),
               ms("bounces"), ms("final gathering"), ms("interpolation"), frame.milliseconds);
    std::fflush(stdout);
}

/// Table 1 and fig. 11: a light, the view, a material changes; several lights. What changes is motion, as in
/// the window: direct light and entry points are lit by shadow maps. At rest they are lit by rays.
inline Result<void> times_of_paths(Stage& stage, const BenchRun& run, const std::string& what) {
    heading("table 1 and fig. 11: " + what +
            ", ms (the paper, GeForce 7800 GTX, Box to Room: T_di 6 to 30, T_pe 11 to 23, T_hvds 11 to 112, "
            "T_fg 5 to 162, T_splat 76 to 302, light 109 to 621, view 87 to 492, material 1271 to 1911; "
            "8 lights take 1.3 to 1.8 times as long as one); in motion, with shadow maps");
    fmt::print("{:>22} {:>8} {:>8} {:>8} {:>8} {:>8} {:>8}\n", "changed", "direct", "entries", "bounces",
               "gather", "pixels", "frame");
    LUCARNE_TRY(stage.picture("paths", stage.settings()));
    stage.request().moving = true;
    const gi::Scene original = stage.pipeline().scene();
    const auto change_scene = [&](const auto& change) {
        return stage.frames_after(run.frames(5), [&](int i) -> Result<void> {
            gi::Scene scene = stage.pipeline().scene();
            change(scene, i);
            return stage.pipeline().set_scene(std::move(scene));
        });
    };
    LUCARNE_ASSIGN(const auto view, stage.frames_after(run.frames(5), [&](int) -> Result<void> {
        stage.request().camera.position.x += .001;
        return {};
    }));
    row_of_steps("view", view);
    LUCARNE_ASSIGN(const auto material, change_scene([](gi::Scene& scene, int) {
                       for (gi::SceneMaterial& of : scene.materials) of.diffuse *= .99;
                   }));
    row_of_steps("material", material);
    const auto move_lights = [&](const std::string& name, size_t lights) -> Result<void> {
        LUCARNE_ASSIGN(const auto moved, change_scene([&](gi::Scene& scene, int i) {
                           scene.lights.assign(lights, original.lights.at(0));
                           for (size_t k = 0; k < lights; ++k)
                               scene.lights[k].position.x += .01 * static_cast<double>(k + i + 1);
                       }));
        row_of_steps(name, moved);
        return {};
    };
    for (const size_t lights : run.cases<size_t>({1, 2, 4, 8}))
        LUCARNE_TRY(move_lights(fmt::format("{} moved", lights), lights));
    stage.request().moving = false;
    return move_lights("1 moved, at rest", 1);
}

inline Result<void> figures_of_paths(gi::Device& device, const BenchRun& run) {
    if (run.wants("7") || run.wants("12") || run.wants("13")) LUCARNE_TRY(figures_of_cells(device, run));
    if (!run.wants("1")) return {};
    heading("Yue et al. 2007: Cornell box, nave, arbour and loft stand for Box, Sponza, Tree and Room");
    using Named = std::pair<std::string, std::string>;
    for (const auto& [name, scene] : run.cases<Named>(
             {{"cornell", "cornell"}, {"nave", "nave"}, {"arbour", "arbour"}, {"loft", "loft-lamps"}})) {
        LUCARNE_ASSIGN(const Scan scan, Scan::create(name, run.points(200'000), run.folder));
        Stage stage(device, scan);
        const ImageSize size = run.size({160, 120});
        LUCARNE_TRY(stage.open(
            {.scene = scene_file(scene), .size = size, .preset = run.trial() ? "preview" : "interactive"}));
        const std::string what = fmt::format("{}, {}x{}", scene, size.width, size.height);
        LUCARNE_TRY(errors_of_paths(stage, run, what));
        LUCARNE_TRY(times_of_paths(stage, run, what));
    }
    return {};
}

}  // namespace lucarne::bench
