// Figs 6 to 8 of Harada 2014 on scenes of ours: where the time of a picture goes, its indirect light, and
// what leaving most points out changes.
#pragma once

#include <algorithm>
#include <array>
#include <cmath>
#include <cstdio>
#include <string>
#include <vector>

#include <fmt/format.h>

#include "gi/bounce_options.h"
#include "gi/compare/metrics.h"
#include "gi/engines/environment/options.h"
#include "gi/post/exposure.h"
#include "gi/post/tone_map.h"
#include "gi/shared/surfel_code.h"
#include "io/image/image.h"
#include "tests/bench/bench_run.h"
#include "tests/bench/scan.h"
#include "tests/bench/stage.h"

namespace lucarne::bench {

/// Writes how two pictures of one exposure differ on the screen, four times as much as they do.
inline Result<void> write_difference(const std::filesystem::path& path, const Stage::Picture& a,
                                     const Stage::Picture& b, const ImageSize& size) {
    const double ev = gi::log_average_exposure(b.pixels);
    const auto first = gi::tone_map(a.pixels, gi::ToneMap::filmic, {ev}),
               second = gi::tone_map(b.pixels, gi::ToneMap::filmic, {ev});
    io::Image8 image{.width = size.width, .height = size.height};
    for (size_t i = 0; i < first.size(); ++i)
        for (int k = 0; k < 3; ++k) {
            const float away = std::abs(gi::linear_to_srgb(first[i][k]) - gi::linear_to_srgb(second[i][k]));
            image.bytes.push_back(static_cast<uint8_t>(std::lround(255 * std::min(4 * away, 1.0f))));
        }
    return io::write_png(path, image, true);
}

/// Prints which parts of a picture of one bounce take how long (fig. 6), and writes its indirect light (fig.
/// 7) and how it differs from one for which all surfels gather (fig. 8).
inline Result<void> figures_of_environment_parts(gi::Device& device, const BenchRun& run) {
    const ImageSize size = run.size({640, 360});
    fmt::print(
        "\nfig. 6: ms of the parts of a picture, one bounce, {}x{}, preset interactive; fig. 8: against "
        "--brute-force\n{:<16}",
        size.width, size.height, "scene");
    constexpr std::array kParts = {
        "primary points", "micro-buffers", "secondary points", "light at secondary points",
        "propagation",    "caches",        "interpolation",    "lonely pixels",
        "direct light"};
    for (const char* part : kParts) fmt::print(" {:>{}}", part, std::string(part).size());
    fmt::print(" {:>7} {:>7} {:>10}\n", "all", "CPU-ms", "relMSE");
    for (const std::string& name : run.cases<std::string>({"statue", "primitives", "survey"})) {
        LUCARNE_ASSIGN(const Scan scan, Scan::create(name, run.points(500'000), run.folder,
                                                     name == "survey" ? "" : "--even --normals"));
        Stage stage(device, scan);
        LUCARNE_TRY(stage.open({.scene = scene_file(name + "-sky"),
                                .size = size,
                                .preset = run.trial() ? "preview" : "interactive"}));
        gi::EngineSettings settings = stage.settings();
        settings.set(gi::kBounces, 1);
        LUCARNE_TRY(stage.picture("environment", settings));  // the kernels, first loads
        LUCARNE_ASSIGN(const Stage::Picture picture, stage.picture("environment", settings));
        settings.set(gi::environment::kBruteForce, true);
        LUCARNE_ASSIGN(const Stage::Picture all, stage.picture("environment", settings));
        settings.set(gi::environment::kBruteForce, false);
        LUCARNE_ASSIGN(const gi::ImageMetrics metrics, gi::compare_images(picture.pixels, all.pixels));
        fmt::print("{:<16}", name + "-sky");
        for (const char* part : kParts)
            fmt::print(" {:>{}.0f}", 1e3 * pass_seconds(picture.last, part), std::string(part).size());
        fmt::print(" {:>7.0f} {:>7.0f} {:>10.2g}\n", 1e3 * picture.seconds, 1e3 * picture.cpu_seconds,
                   metrics.rel_mse);
        std::fflush(stdout);
        LUCARNE_TRY(
            write_difference(run.folder / fmt::format("environment-{}-fig-8.png", name), picture, all, size));
        settings.set(gi::kOnlyBounce, 1);
        LUCARNE_TRY(stage.picture("environment", settings));
        LUCARNE_TRY(stage.write(run.folder / fmt::format("environment-{}-fig-7-indirect.png", name)));
    }
    return {};
}

}  // namespace lucarne::bench
