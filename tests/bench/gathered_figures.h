// The experiments of the papers behind the engines that gather light, repeated: Harada 2014 (table 1 and fig.
// 5 on scenes of ours) and Ritschel et al. 2009 (figs 5 to 14).
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
#include "gi/lighting/light_options.h"
#include "tests/bench/accuracy.h"
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

/// Prints how far a picture is from the truth, and what it took.
inline Result<void> print_against(const std::string& name, const Stage::Picture& picture,
                                  const Scan::Truth& truth) {
    LUCARNE_ASSIGN(const auto error, gi::compare_with_halves(picture.pixels, truth.first, truth.second));
    double gather = 0;
    for (const char* pass : {"radiosity", "photons", "VPLs", "bright light", "gather", "upsample"})
        gather += pass_seconds(picture.last, pass);
    fmt::print("{:>24} {:>12.2g} {:>10.1g} {:>10.2f} {:>9.2f} {:>9.2f} {:>12.0f}\n", name, error.rel_mse,
               error.standard_error,
               100 * (gi::mean_luminance(picture.pixels) / gi::mean_luminance(truth.whole) - 1), gather,
               picture.cpu_seconds, statistic(picture.last, "gather_points"));
    std::fflush(stdout);
    return {};
}
inline void columns_against(const std::string& text, const char* first) {
    heading(text);
    fmt::print("{:>24} {:>12} {:>10} {:>10} {:>9} {:>9} {:>12}\n", first, "relMSE", "+-", "energy %",
               "gather s", "CPU-s", "gathers");
}

/// Prints error and time of `micro` by one of its options.
inline Result<void> sweep_of_micro(Stage& stage, const Scan::Truth& truth, gi::EngineSettings settings,
                                   const gi::Option<uint32_t>& option, const std::vector<int64_t>& values) {
    for (const int64_t value : values) {
        settings.set(option, static_cast<uint32_t>(value));
        LUCARNE_ASSIGN(const Stage::Picture picture, stage.picture("micro", settings));
        LUCARNE_TRY(print_against(fmt::to_string(value), picture, truth));
    }
    return {};
}

/// Figs 10, 11 and 12 on one bounce, and 9: `vpl` and `micro` of the same presets.
inline Result<void> figures_of_one_bounce(gi::Device& device, const BenchRun& run, const std::string& scene) {
    LUCARNE_ASSIGN(const Scan scan, Scan::create(scene, run.points(300'000), run.folder));
    Stage stage(device, scan);
    const ImageSize size = run.size({160, 120});
    LUCARNE_TRY(
        stage.open({.scene = scene_file(scene), .size = size, .preset = run.trial() ? "preview" : "high"}));
    gi::EngineSettings settings = stage.settings();
    settings.set(gi::kOnlyBounce, 1);
    LUCARNE_ASSIGN(const Scan::Truth truth, stage.truth(settings, std::max<uint64_t>(run.count(256), 2)));
    LUCARNE_TRY(stage.picture("micro", settings));  // the kernels, first loads
    const std::string what =
        fmt::format("{}, bounce 1, {}x{}, against the reference", scene, size.width, size.height);
    settings.set(gi::kGatherEvery, 1);
    columns_against("fig. 12: side of the micro-buffers, every pixel gathers: " + what +
                        " (the paper, 256x256 of a plant: 8 3.2 Hz, 16 1.5 Hz, 24 .7 Hz)",
                    "side");
    const std::vector<int64_t> sides(gi::kBufferSides.begin(), gi::kBufferSides.end());
    LUCARNE_TRY(sweep_of_micro(stage, truth, settings, gi::kMicroBuffer, run.cases(sides)));
    columns_against("fig. 10: one pixel of so many along both axes gathers, 24 x 24: " + what +
                        " (the paper, 512x512: 1 .83 Hz, 2 2.2 Hz, 4 4.2 Hz)",
                    "gather every");
    settings.set(gi::kMicroBuffer, 24);
    LUCARNE_TRY(sweep_of_micro(stage, truth, settings, gi::kGatherEvery, run.cases<int64_t>({1, 2, 4})));
    columns_against(
        "fig. 11: rays of the pixels, or the pixels at the middles of nodes, 24 x 24, every pixel gathers: " +
            what + " (the paper, 256x256: 2.5 Hz with rays, 2.9 Hz without and holes)",
        "fill");
    settings.set(gi::kGatherEvery, 1);
    for (const gi::Fill fill : {gi::Fill::rays, gi::Fill::pixels}) {
        settings.set(gi::kFill, fill);
        LUCARNE_ASSIGN(const Stage::Picture picture, stage.picture("micro", settings));
        const std::string name(gi::kFillKinds[static_cast<size_t>(fill)]);
        LUCARNE_TRY(print_against(name, picture, truth));
        LUCARNE_TRY(stage.write(run.folder / fmt::format("micro-{}-fill-{}.png", scene, name)));
    }
    columns_against("fig. 9: VPLs and final gathering, presets of this program: " + what +
                        " (the paper: less error than imperfect shadow maps at 5 Hz each)",
                    "engine");
    for (const std::string& preset : run.cases<std::string>({"interactive", "high"}))
        for (const std::string engine : {"vpl", "micro"}) {
            LUCARNE_ASSIGN(const viewer::Preset of_preset, viewer::find_preset(preset));
            gi::EngineSettings of = of_preset.engine;
            of.set(gi::kOnlyBounce, 1);
            LUCARNE_ASSIGN(const Stage::Picture picture, stage.picture(engine, of));
            LUCARNE_TRY(print_against(engine + " " + preset, picture, truth));
        }
    return {};
}

/// Fig. 5: specular lobes with directions of their own, and with those of a half space.
inline Result<void> figures_of_lobes(gi::Device& device, const BenchRun& run) {
    LUCARNE_ASSIGN(const Scan scan, Scan::create("cornell", run.points(300'000), run.folder));
    const ImageSize size = run.size({64, 40});
    for (const int exponent : run.cases<int>({1, 5, 20, 1000})) {
        Stage stage(device, scan);
        LUCARNE_TRY(stage.open(
            {.scene = shiny_scene(run, exponent), .size = size, .preset = run.trial() ? "preview" : "high"}));
        gi::EngineSettings settings = stage.settings();
        settings.set(gi::kOnlyBounce, 1);
        LUCARNE_ASSIGN(const Scan::Truth truth,
                       stage.truth(settings, std::max<uint64_t>(run.count(2048), 2)));
        columns_against(
            fmt::format("fig. 5: directions of specular micro-buffers, exponent {}, bounce 1, {}x{}",
                        exponent, size.width, size.height),
            "directions of");
        for (const gi::Warp warp : {gi::Warp::lobe, gi::Warp::hemisphere}) {
            settings.set(gi::kWarp, warp);
            LUCARNE_ASSIGN(const Stage::Picture picture, stage.picture("micro", settings));
            LUCARNE_TRY(
                print_against(std::string(gi::kWarpKinds[static_cast<size_t>(warp)]), picture, truth));
        }
    }
    return {};
}

/// Figs 6 to 8: the second bounce, from light that VPLs, radiosity or photons brought to surfels, and by VPLs
/// without a gather.
inline Result<void> figures_of_light_points(gi::Device& device, const BenchRun& run) {
    using Scene = std::string;
    for (const Scene& scene : run.cases<Scene>({"cornell", "cornell-glossy", "nave"})) {
        const std::string model = scene.substr(0, scene.find('-'));
        LUCARNE_ASSIGN(const Scan scan, Scan::create(model, run.points(300'000), run.folder));
        Stage stage(device, scan);
        const ImageSize size = run.size({96, 72});
        LUCARNE_TRY(stage.open(
            {.scene = scene_file(scene), .size = size, .preset = run.trial() ? "preview" : "high"}));
        gi::EngineSettings settings = stage.settings();
        settings.set(gi::kOnlyBounce, 2);
        LUCARNE_ASSIGN(const Scan::Truth truth, stage.truth(settings, std::max<uint64_t>(run.count(256), 2)));
        columns_against(fmt::format("figs 6 to 8: {}, bounce 2, {}x{}", scene, size.width, size.height),
                        "light points");
        settings.set(gi::kLightPoints, gi::LightPoints::radiosity);
        for (const int64_t level : run.cases<int64_t>({10, 12, 14})) {
            settings.set(gi::kRadiosityLevel, static_cast<uint32_t>(level));
            LUCARNE_ASSIGN(const Stage::Picture picture, stage.picture("micro", settings));
            LUCARNE_TRY(print_against(fmt::format("radiosity, 2^{} places", level), picture, truth));
        }
        settings.set(gi::kLightPoints, gi::LightPoints::photons);
        for (const int64_t photons : run.cases<int64_t>({65'536, 1'048'576, 4'194'304})) {
            settings.set(gi::kPhotons, static_cast<uint64_t>(photons));
            LUCARNE_ASSIGN(const Stage::Picture picture, stage.picture("micro", settings));
            LUCARNE_TRY(print_against(fmt::format("{} photons", photons), picture, truth));
        }
        settings.set(gi::kLightPoints, gi::LightPoints::vpls);
        for (const int64_t vpls : run.cases<int64_t>({256, 1024, 4096}))
            for (const std::string engine : {"micro", "vpl"}) {
                settings.set(gi::kVpls, static_cast<uint32_t>(vpls));
                LUCARNE_ASSIGN(const Stage::Picture picture, stage.picture(engine, settings));
                const std::string name = fmt::format("{} VPLs, {}", vpls, engine);
                LUCARNE_TRY(print_against(name, picture, truth));
            }
    }
    return {};
}

/// Fig. 14: few gathering pixels, all of them, and paths, of closed, thin, large and glossy scenes.
inline Result<void> figures_of_scenes(gi::Device& device, const BenchRun& run) {
    struct Example {
        std::string scan, sampling, scene;
    };
    const ImageSize size = run.size({160, 120});
    for (const Example& example : run.cases<Example>({{"cornell", "--even --normals", "cornell"},
                                                      {"survey", "", "survey-sky"},  // trees
                                                      {"nave", "--even --normals", "nave"},
                                                      {"cornell", "--even --normals", "cornell-glossy"}})) {
        LUCARNE_ASSIGN(const Scan scan,
                       Scan::create(example.scan, run.points(300'000), run.folder, example.sampling));
        Stage stage(device, scan);
        LUCARNE_TRY(stage.open(
            {.scene = scene_file(example.scene), .size = size, .preset = run.trial() ? "preview" : "high"}));
        gi::EngineSettings settings = stage.settings();
        settings.set(gi::kBounces, 1);
        LUCARNE_ASSIGN(const Scan::Truth truth, stage.truth(settings, std::max<uint64_t>(run.count(256), 2)));
        columns_against(fmt::format("fig. 14: {}, direct light and bounce 1, {}x{}", example.scene,
                                    size.width, size.height),
                        "gather every");
        for (const uint32_t every : {4u, 1u}) {
            settings.set(gi::kGatherEvery, every);
            LUCARNE_ASSIGN(const Stage::Picture picture, stage.picture("micro", settings));
            LUCARNE_TRY(print_against(fmt::to_string(every), picture, truth));
            LUCARNE_TRY(stage.write(run.folder / fmt::format("micro-{}-{}.png", example.scene, every)));
        }
    }
    return {};
}

/// Fig. 13 and the shares of time in section 5.
inline Result<void> figures_of_sizes(gi::Device& device, const BenchRun& run) {
    heading(
        "fig. 13: surfels of cornell, every pixel gathers, 24 x 24 (the paper: sub-linear from 2^14 to 2^21; "
        "150M samples/s)");
    fmt::print("{:>10} {:>9} {:>10} {:>14} {:>40}\n", "surfels", "tree s", "gather s", "M samples/s",
               "% tree, light of surfels, gather, direct");
    for (const uint64_t points : run.cases<uint64_t>({16'384, 131'072, 1'048'576})) {
        LUCARNE_ASSIGN(const Scan scan, Scan::create("cornell", run.points(points), run.folder, "--even"));
        Stage stage(device, scan);
        LUCARNE_TRY(stage.open({.scene = scene_file("cornell"),
                                .size = run.size({256, 256}),
                                .preset = run.trial() ? "preview" : "high"}));
        gi::EngineSettings settings = stage.settings();
        settings.set(gi::kBounces, 1);
        LUCARNE_ASSIGN(const Stage::Picture picture, stage.picture("micro", settings));
        const auto seconds = [&](const char* pass) { return pass_seconds(picture.last, pass); };
        const double gather = seconds("gather"), tree = seconds("surfel tree"),
                     light = seconds("surfel light") + seconds("radiosity"), direct = seconds("direct light"),
                     side = settings[gi::kMicroBuffer];
        const double all = gather + tree + light + direct;
        fmt::print("{:>10.0f} {:>9.3f} {:>10.3f} {:>14.1f} {:>19.1f} {:>6.1f} {:>6.1f} {:>6.1f}\n",
                   statistic(picture.last, "surfels"), tree, gather,
                   statistic(picture.last, "gather_points") * side * side / gather / 1e6, 100 * tree / all,
                   100 * light / all, 100 * gather / all, 100 * direct / all);
        std::fflush(stdout);
    }
    return {};
}

inline Result<void> figures_of_micro(gi::Device& device, const BenchRun& run) {
    for (const std::string& scene : run.cases<std::string>({"cornell", "nave"}))
        LUCARNE_TRY(figures_of_one_bounce(device, run, scene));
    LUCARNE_TRY(figures_of_lobes(device, run));
    LUCARNE_TRY(figures_of_light_points(device, run));
    LUCARNE_TRY(figures_of_scenes(device, run));
    return figures_of_sizes(device, run);
}

}  // namespace lucarne::bench
