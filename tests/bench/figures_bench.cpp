// The experiments of Preiner 2010 ("Real-Time Global Illumination in Point Clouds"), section 5, repeated: the
// light of each bounce (fig. 9), times by bounces, VPLs and interleaving in a Cornell box and a cathedral
// (figs 10 to 12), caustics (fig. 13) and a glossy box (fig. 14). `lucarne_figures [FOLDER] [ENGINE] [--scale
// S] [--only N]` prints tables and leaves scans and pictures in FOLDER (./run figures: figures). ENGINE:
// micro or environment (gathered_figures.h) instead; or `yue [1] [7] [12] [13]` (paths_figures.h,
// paths_cells.h): table 1 (with figs 10 and 11) and these figures of Yue et al. 2007; or `gaitatzes [5] [6]
// [7]`: these chapters of Gaitatzes 2012 (volume_figures.h, voxel_figures.h). This is a program and not a
// test; it takes about ten minutes on two cores.
#include <algorithm>
#include <cmath>
#include <cstdio>
#include <filesystem>
#include <string>
#include <thread>
#include <vector>

#include <fmt/format.h>

#include "gi/bounce_options.h"
#include "gi/compare/metrics.h"
#include "gi/engines/vpl/options.h"
#include "gi/lighting/light_options.h"
#include "tests/bench/bench_run.h"
#include "tests/bench/environment_figures.h"
#include "tests/bench/gathered_figures.h"
#include "tests/bench/paths_figures.h"
#include "tests/bench/scan.h"
#include "tests/bench/stage.h"
#include "tests/bench/volume_figures.h"
#include "tests/bench/voxel_figures.h"

namespace lucarne {
namespace {

using bench::BenchRun, bench::heading, bench::Scan, bench::Stage;

/// Sets the number of VPLs and an atlas that gives each map about 64 x 64 texels, as in the paper.
void set_vpls(gi::EngineSettings& settings, uint32_t vpls) {
    settings.set(gi::kVpls, vpls);
    settings.set(gi::vpl::kAtlas,
                 static_cast<uint32_t>(std::ceil(64 * std::sqrt(static_cast<double>(vpls)))));
}

Result<void> figure_9(gi::Device& device, const Scan& scan, const BenchRun& run) {
    const uint32_t side = run.side(512);
    heading(fmt::format("fig. 9: cornell, 256 VPLs, 4 x 4 interleaved, {0} x {0}", side));
    fmt::print("{:>8} {:>12} {:>14} {:>16} {:>16}\n", "bounces", "ms a frame", "of all cores",
               "mean luminance", "more than before");
    Stage stage(device, scan);
    LUCARNE_TRY(stage.open({.scene = bench::scene_file("cornell"), .size = {side, side}}));
    gi::EngineSettings settings = stage.settings();
    LUCARNE_TRY(stage.frames(settings, 1));  // warm-up: shaders, first loads
    double before = 0;
    for (uint32_t bounces = 0; bounces <= 4; ++bounces) {
        settings.set(gi::kBounces, bounces);
        LUCARNE_ASSIGN(const auto measured, stage.frames(settings, static_cast<int>(run.count(3))));
        fmt::print("{:>8} {:>12.0f} {:>14.0f} {:>16.4f} {:>16}\n", bounces, measured.milliseconds,
                   measured.processor, measured.luminance,
                   bounces ? fmt::format("{:+.1f} %", 100 * (measured.luminance / before - 1)) : "");
        before = measured.luminance;
        LUCARNE_TRY(stage.write(run.folder / fmt::format("fig-9-bounces-{}.png", bounces)));
    }
    return {};
}

/// Measures figs 10 (a box) and 11, 12 (a cathedral). The interleaved pictures of the paper's fig. 12 lack
/// the factor n^2; here the indirect light must be the same for every n.
Result<void> sweep(gi::Device& device, const Scan& scan, const std::string& scene, const std::string& figure,
                   const BenchRun& run) {
    const uint32_t side = run.side(256);
    Stage stage(device, scan);
    LUCARNE_TRY(stage.open({.scene = bench::scene_file(scene), .size = {side, side}}));
    gi::EngineSettings settings = stage.settings();
    LUCARNE_TRY(stage.frames(settings, 1));
    settings.set(gi::kBounces, 0);
    LUCARNE_ASSIGN(const auto direct, stage.frames(settings, 1));
    heading(
        fmt::format("{}: {}, {} x {}, all VPLs anew: ms a frame / of all cores (indirect "
                    "light over that of interleave 1)",
                    figure, scene, side, side));
    fmt::print("{:>6} {:>12} {:>22} {:>22} {:>22}\n", "VPLs", "interleave", "1 bounce", "2 bounces",
               "3 bounces");
    for (const uint32_t vpls : {64u, 128u, 256u, 1024u}) {
        if (vpls > std::max<uint64_t>(run.count(1024), 64)) break;
        double whole[4] = {};
        for (const uint32_t interleave : {1u, 2u, 4u}) {
            set_vpls(settings, vpls);
            settings.set(gi::vpl::kInterleave, interleave);
            fmt::print("{:>6} {:>12}", vpls, fmt::format("{0} x {0}", interleave));
            for (uint32_t bounces = 1; bounces <= 3; ++bounces) {
                settings.set(gi::kBounces, bounces);
                // A frame with a thousand VPLs takes seconds, which vary less, so one frame is enough.
                LUCARNE_ASSIGN(const auto measured,
                               stage.frames(settings, vpls < 1024 ? static_cast<int>(run.count(3)) : 1));
                const double indirect = measured.luminance - direct.luminance;
                if (interleave == 1) whole[bounces] = indirect;
                fmt::print(" {:>22}", fmt::format("{:.0f} / {:.0f} ({:.3f})", measured.milliseconds,
                                                  measured.processor, indirect / whole[bounces]));
                std::fflush(stdout);
                const std::string name =
                    fmt::format("fig-12-{}-bounces-{}-interleave-{}.png", scene, bounces, interleave);
                if (vpls == 256 && interleave != 2) LUCARNE_TRY(stage.write(run.folder / name));
            }
            fmt::print("\n");
        }
    }
    return {};
}

double brightest(const std::vector<glm::vec4>& picture) {
    double most = 0;
    for (const glm::vec4& pixel : picture) most = std::max(most, gi::luminance(pixel));
    return most;
}

/// Returns means of 4 x 4 pixels of a square picture. A path tracer hits caustics by chance, so its single
/// pixels are too noisy to divide by.
std::vector<glm::vec4> coarse(const std::vector<glm::vec4>& picture, size_t side) {
    constexpr size_t kBlock = 4;
    std::vector<glm::vec4> means(picture.size() / (kBlock * kBlock), glm::vec4(0.0f));
    for (size_t i = 0; i < picture.size(); ++i)
        means[i / side / kBlock * (side / kBlock) + i % side / kBlock] +=
            picture[i] / static_cast<float>(kBlock * kBlock);
    return means;
}

/// Where the light is concentrated: its share of a picture, and its centre.
struct Spot {
    double light = 0, x = 0, y = 0;
};
Spot spot_within(const std::vector<glm::vec4>& picture, const std::vector<bool>& mask, size_t width) {
    Spot spot;
    for (size_t i = 0; i < picture.size(); ++i) {
        if (!mask[i]) continue;
        const double light = gi::luminance(picture[i]);
        spot.light += light;
        spot.x += light * static_cast<double>(i % width);
        spot.y += light * static_cast<double>(i / width);
    }
    spot.x /= spot.light;
    spot.y /= spot.light;
    return spot;
}

void judge(const std::string& what, const std::vector<glm::vec4>& picture, const Scan::Truth& truth) {
    const auto error = gi::compare_with_halves(picture, truth.first, truth.second);
    const double energy = gi::mean_luminance(picture) / gi::mean_luminance(truth.whole) - 1;
    fmt::print("{:<44} relMSE {:>7} energy {:+.1f} %, the brightest {:.2f} of the reference's\n", what,
               error ? fmt::format("{:.4f}", error->rel_mse) : error.error().line(), 100 * energy,
               brightest(picture) / brightest(truth.whole));
    std::fflush(stdout);
}

Result<void> figure_13(const BenchRun& run) {
    heading(
        "fig. 13: caustics, the first bounce alone, preset high, means of 4 x 4 of 128 x 128 pixels, against "
        "the reference");
    constexpr size_t kSide = 128;
    for (const std::string& scene : run.cases<std::string>({"ring", "paraboloid"})) {
        LUCARNE_ASSIGN(const Scan scan, Scan::create(scene, run.points(2'000'000), run.folder));
        const std::string common = fmt::format("--size {0}x{0} --preset high --only-bounce 1 ", kSide);
        LUCARNE_ASSIGN(Scan::Truth truth,
                       scan.truth("truth", common + fmt::format("--samples {}", run.count(2048))));
        for (auto* picture : {&truth.whole, &truth.first, &truth.second}) *picture = coarse(*picture, kSide);
        // The caustic: pixels brighter than a third of the brightest.
        std::vector<bool> mask;
        const double limit = brightest(truth.whole) / 3;
        for (const glm::vec4& pixel : truth.whole) mask.push_back(gi::luminance(pixel) > limit);
        const Spot right = spot_within(truth.whole, mask, kSide / 4);
        for (const uint64_t frames : run.cases<uint64_t>({1, run.count(16)})) {
            LUCARNE_ASSIGN(const auto picture,
                           scan.picture(fmt::format("frames-{}", frames),
                                        common + fmt::format("--no-antialiasing --frames {}", frames)));
            const auto means = coarse(picture, kSide);
            judge(fmt::format("{}, {} frame{}", scene, frames, frames == 1 ? "" : "s"), means, truth);
            const Spot spot = spot_within(means, mask, kSide / 4);
            fmt::print("{:<44} {:+.1f} % of its light, {:.1f} pixels off\n", "  the caustic",
                       100 * (spot.light / right.light - 1),
                       4 * std::hypot(spot.x - right.x, spot.y - right.y));
        }
        LUCARNE_TRY(scan.render("fig-13.png", run.picture(512, "high") + "--bounces 2"));
    }
    return {};
}

Result<void> figure_14(Scan& scan, const BenchRun& run) {
    heading("fig. 14: cornell, .5 diffuse, .45 specular, shininess 1000, the first bounce alone, 64 x 64");
    scan.light_by(bench::scene_file("cornell-glossy"));
    const std::string common = "--size 64x64 --only-bounce 1 --preset ";
    LUCARNE_ASSIGN(const auto truth,
                   scan.truth("truth", common + fmt::format("high --samples {}", run.count(16384))));
    LUCARNE_ASSIGN(const auto interactive, scan.picture("interactive", common + "interactive"));
    judge("256 VPLs, 4 x 4 interleaved, one frame", interactive, truth);
    LUCARNE_ASSIGN(const auto high, scan.picture("high", common + "high"));
    judge("1024 VPLs, one frame", high, truth);
    LUCARNE_ASSIGN(const auto averaged,
                   scan.picture("averaged", common + fmt::format("high --no-antialiasing --seconds {}",
                                                                 run.seconds(30))));
    judge("1024 VPLs, averaged for 30 s", averaged, truth);
    for (const std::string& preset : run.cases<std::string>({"interactive", "high"}))
        LUCARNE_TRY(scan.render("fig-14-" + preset + ".png", run.picture(512, preset) + "--bounces 2"));
    return {};
}

/// --only: 9, 10, 11 (with 12), 13 or 14; 0: all.
Result<void> make_figures(const BenchRun& run) {
    LUCARNE_ASSIGN(const auto device, gi::Device::headless());
    fmt::print("{}; {} hardware threads\n", device->info().renderer, std::thread::hardware_concurrency());
    if (run.subject == "micro") return bench::figures_of_micro(*device, run);
    if (run.subject == "environment") {
        LUCARNE_TRY(bench::figures_of_environment(*device, run));
        return bench::figures_of_environment_parts(*device, run);
    }
    if (run.subject == "yue") return bench::figures_of_paths(*device, run);
    if (run.subject == "gaitatzes") {
        if (run.wants("5")) LUCARNE_TRY(bench::figures_of_chapter_5(*device, run));
        if (run.wants("6")) LUCARNE_TRY(bench::figures_of_chapter_6(*device, run));
        return run.wants("7") ? bench::figures_of_chapter_7(*device, run) : Result<void>{};
    }
    const double only = run.option("only", 0);
    const auto wanted = [&](int figure) { return only == 0 || only == figure; };
    if (wanted(9) || wanted(10) || wanted(14)) {
        LUCARNE_ASSIGN(Scan cornell, Scan::create("cornell", run.points(2'000'000), run.folder));
        if (wanted(9)) LUCARNE_TRY(figure_9(*device, cornell, run));
        if (wanted(10)) LUCARNE_TRY(sweep(*device, cornell, "cornell", "fig. 10", run));
        if (wanted(14)) LUCARNE_TRY(figure_14(cornell, run));
    }
    if (wanted(11)) {
        LUCARNE_ASSIGN(const Scan nave, Scan::create("nave", run.points(4'000'000), run.folder));
        LUCARNE_TRY(sweep(*device, nave, "nave", "figs 11 and 12", run));
    }
    return wanted(13) ? figure_13(run) : Result<void>{};
}

}  // namespace
}  // namespace lucarne

int main(int argc, char** argv) {
    return lucarne::bench::bench_main(argc, argv, lucarne::make_figures,
                                      {.options = {"only"},
                                       .subjects = {"micro", "environment", "yue", "gaitatzes"},
                                       .parts = {"1", "5", "6", "7", "12", "13"}});
}
