// The experiments of the papers behind the engines that gather light, repeated: Harada 2014 (table 1 and fig.
// 5 on scenes of ours) and Ritschel et al. 2009 (figs 10 and 12).
#pragma once

#include <algorithm>
#include <cstdio>
#include <string>
#include <string_view>
#include <vector>

#include <fmt/format.h>

#include "gi/bounce_options.h"
#include "gi/compare/metrics.h"
#include "gi/engines/environment/options.h"
#include "gi/gather/gather_options.h"
#include "tests/bench/bench_run.h"
#include "tests/bench/scan.h"
#include "tests/bench/stage.h"

namespace lucarne::bench {

inline void heading(const std::string& text) {
    fmt::print("\n{}\n", text);
    std::fflush(stdout);
}

/// Prints how many points gather in pictures of open scenes, and how many would without the shortcuts.
inline Result<void> figures_of_environment(gi::Device& device, const BenchRun& run) {
    const ImageSize size = run.size({640, 360});
    const std::string preset = run.trial() ? "preview" : "high";
    heading(fmt::format("table 1 and fig. 5: points of environment, one bounce, {}x{}, preset {}", size.width,
                        size.height, preset));
    fmt::print("{:<12} {:>9} {:>8} {:>10} {:>9} {:>10} {:>12} {:>9} {:>9} {:>12}\n", "scene", "surfels",
               "primary", "secondary", "after up", "after down", "gathering %", "s", "CPU-s", "lonely");
    struct Open {
        std::string scan, sampling, scene;
        uint64_t points;
    };
    for (const Open& open : run.cases<Open>({{"statue", "--even --normals", "statue-sky", 300'000},
                                             {"statue", "--even --normals", "statue-sky", 1'000'000},
                                             {"primitives", "--even --normals", "primitives-sky", 1'000'000},
                                             {"survey", "", "survey-sky", 1'000'000},
                                             {"nave", "--even --normals", "nave-sky", 1'000'000}})) {
        LUCARNE_ASSIGN(const Scan scan,
                       Scan::create(open.scan, run.points(open.points), run.folder, open.sampling));
        Stage stage(device, scan);
        LUCARNE_TRY(stage.open({.scene = scene_file(open.scene), .size = size, .preset = preset}));
        gi::EngineSettings settings = stage.settings();
        settings.set(gi::kBounces, 1);
        LUCARNE_TRY(stage.picture("environment", settings));  // the kernels, first loads
        LUCARNE_ASSIGN(const Stage::Picture picture, stage.picture("environment", settings));
        const auto stat = [&](std::string_view name) { return statistic(picture.last, name); };
        fmt::print(
            "{:<12} {:>9.0f} {:>8.0f} {:>10.0f} {:>9.0f} {:>10.0f} {:>12.2f} {:>9.2f} {:>9.2f} {:>12.0f}\n",
            open.scene, stat("surfels"), stat("primary_points"), stat("secondary_points"), stat("after_up"),
            stat("after_down"), 100 * (stat("primary_points") + stat("after_down")) / stat("surfels"),
            picture.seconds, picture.cpu_seconds, stat("lonely_pixels"));
        std::fflush(stdout);
        LUCARNE_TRY(stage.write(run.folder / fmt::format("environment-{}.png", open.scene)));
    }
    return {};
}

/// Prints error and time of `micro` by one of its options.
inline Result<void> sweep_of_micro(Stage& stage, const Scan::Truth& truth, gi::EngineSettings settings,
                                   const gi::Option<uint32_t>& option, const std::vector<int64_t>& values) {
    for (const int64_t value : values) {
        settings.set(option, static_cast<uint32_t>(value));
        LUCARNE_ASSIGN(const Stage::Picture picture, stage.picture("micro", settings));
        LUCARNE_ASSIGN(const auto error, gi::compare_with_halves(picture.pixels, truth.first, truth.second));
        fmt::print("{:>14} {:>12.2g} {:>10.1g} {:>10.2f} {:>9.2f} {:>9.2f} {:>12.0f}\n", value, error.rel_mse,
                   error.standard_error,
                   100 * (gi::mean_luminance(picture.pixels) / gi::mean_luminance(truth.whole) - 1),
                   pass_seconds(picture.last, "gather") + pass_seconds(picture.last, "upsample"),
                   picture.cpu_seconds, statistic(picture.last, "gather_points"));
        std::fflush(stdout);
    }
    return {};
}

inline Result<void> figures_of_micro(gi::Device& device, const BenchRun& run) {
    using Scene = std::string;
    for (const Scene& scene : run.cases<Scene>({"cornell", "nave"})) {
        LUCARNE_ASSIGN(const Scan scan, Scan::create(scene, run.points(300'000), run.folder));
        Stage stage(device, scan);
        const ImageSize size = run.size({160, 120});
        LUCARNE_TRY(stage.open(
            {.scene = scene_file(scene), .size = size, .preset = run.trial() ? "preview" : "high"}));
        gi::EngineSettings settings = stage.settings();
        settings.set(gi::kOnlyBounce, 1);
        LUCARNE_ASSIGN(const Scan::Truth truth, stage.truth(settings, std::max<uint64_t>(run.count(256), 2)));
        LUCARNE_TRY(stage.picture("micro", settings));  // the kernels, first loads
        const std::string what =
            fmt::format("{}, bounce 1, {}x{}, against the reference", scene, size.width, size.height);
        const auto columns = [](const char* option) {
            fmt::print("{:>14} {:>12} {:>10} {:>10} {:>9} {:>9} {:>12}\n", option, "relMSE", "+-", "energy %",
                       "gather s", "CPU-s", "gathers");
        };
        heading("fig. 12: side of the micro-buffers, every pixel gathers: " + what);
        columns("side");
        settings.set(gi::kGatherEvery, 1);
        const std::vector<int64_t> sides(gi::kBufferSides.begin(), gi::kBufferSides.end());
        LUCARNE_TRY(sweep_of_micro(stage, truth, settings, gi::kMicroBuffer, run.cases(sides)));
        heading("fig. 10: one pixel of so many along both axes gathers, 24 x 24: " + what);
        columns("gather every");
        settings.set(gi::kMicroBuffer, 24);
        LUCARNE_TRY(sweep_of_micro(stage, truth, settings, gi::kGatherEvery, run.cases<int64_t>({1, 2, 4})));
    }
    return {};
}

}  // namespace lucarne::bench
