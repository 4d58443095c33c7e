// The accuracy of the `vpl` engine against analytic truth and against the reference, as a table: every row
// with its preset, its figure and its target. This is a program and not a test: `./run accuracy` takes some
// minutes and prints missed targets. `lucarne_accuracy [FOLDER] [ENGINE] [--scale S]`: pictures go to FOLDER
// (default: a temporary one that is removed). ENGINE: micro, environment (gathered_accuracy.h) or
// volume (volume_accuracy.h) instead.
#include <algorithm>
#include <cmath>
#include <cstdio>
#include <functional>
#include <random>
#include <string>
#include <vector>

#include <fmt/format.h>

#include "gi/bounce_options.h"
#include "gi/compare/metrics.h"
#include "tests/bench/accuracy.h"
#include "tests/bench/bench_run.h"
#include "tests/bench/gathered_accuracy.h"
#include "tests/bench/paths_accuracy.h"
#include "tests/bench/scan.h"
#include "tests/bench/volume_accuracy.h"
#include "tests/gi/engines/analytic_frame.h"
#include "tests/gi/engines/surfel_scenes.h"

namespace lucarne {
namespace {

using bench::BenchRun, bench::high, bench::row, bench::Scan, bench::side;

std::string samples(const BenchRun& run, uint64_t full) {
    return fmt::format(" --samples {}", run.count(full));
}
std::string seconds(const BenchRun& run, double full) {
    return fmt::format(" --no-antialiasing --seconds {}", run.seconds(full));  // as its truth
}

double brightest(const std::vector<glm::vec4>& picture) {
    double most = 0;
    for (const glm::vec4& pixel : picture) most = std::max(most, gi::luminance(pixel));
    return most;
}

Result<void> judge(const std::string& what, const std::vector<glm::vec4>& picture, const Scan::Truth& truth,
                   double rel_mse, double energy) {
    LUCARNE_ASSIGN(const gi::ImageMetrics metrics, gi::compare_images(picture, truth.whole));
    LUCARNE_ASSIGN(const gi::HalvesError unbiased,
                   gi::compare_with_halves(picture, truth.first, truth.second));
    if (rel_mse > 0) {
        row(what, "relMSE, unbiased", unbiased.rel_mse, rel_mse, false);
        row(what, "relMSE without the worst .1 %", metrics.rel_mse_trimmed, rel_mse, false);
    }
    row(what, "energy", metrics.luminance_error, energy, true);
    return {};
}

/// Measures lights with a size, direct and with one bounce: one frame, and the average of `frames`.
Result<void> soft_lights(Scan& scan, const std::string& scene, const std::string& camera, const BenchRun& run,
                         double rel_mse) {
    scan.light_by(bench::scene_file(scene));
    const std::string common = run.picture(128, "interactive") + "--camera " + camera + " ";
    for (const std::string& bounce : run.cases<std::string>({"0", "1"})) {
        const std::string only = common + "--only-bounce " + bounce + " ";
        LUCARNE_ASSIGN(const auto truth, scan.truth("soft", only + samples(run, 512)));
        for (const uint64_t count : run.cases<uint64_t>({1, run.count(16)})) {
            LUCARNE_ASSIGN(
                const auto picture,
                scan.picture("soft-vpl", fmt::format("{} --no-antialiasing --frames {}", only, count)));
            LUCARNE_TRY(judge(fmt::format("{}, bounce {}, {} frames", scene, bounce, count), picture, truth,
                              rel_mse, .03));
        }
    }
    return {};
}

Result<void> cornell(const BenchRun& run) {
    LUCARNE_ASSIGN(Scan scan, Scan::create("cornell", run.points(2'000'000), run.folder));
    const std::string size = run.picture(256, "high");
    Scan::Truth first;
    for (const std::string& preset : run.cases<std::string>({"interactive", "high"})) {
        const std::string common = run.picture(256, preset) + "--only-bounce 1";
        LUCARNE_ASSIGN(first, scan.truth("b1", common + samples(run, 256)));
        LUCARNE_ASSIGN(const auto picture, scan.picture(preset, common));
        LUCARNE_TRY(
            judge("cornell, bounce 1, " + preset, picture, first, preset == "high" ? .0125 : .025, .03));
    }
    for (const int bounce : run.cases<int>({2, 3, 4})) {
        const std::string only = fmt::format("--only-bounce {} ", bounce);
        LUCARNE_ASSIGN(const auto truth, scan.truth("b", size + only + samples(run, 128)));
        LUCARNE_ASSIGN(const auto picture, scan.picture("p", size + only));
        LUCARNE_TRY(judge(fmt::format("cornell, bounce {}, high", bounce), picture, truth, 0, .05));
    }
    LUCARNE_ASSIGN(const auto all, scan.truth("all", size + "--bounces 4" + samples(run, 128)));
    LUCARNE_ASSIGN(const auto together, scan.picture("all-vpl", size + "--bounces 4"));
    LUCARNE_TRY(judge("cornell, bounces 0 to 4, high", together, all, 0, .03));
    LUCARNE_ASSIGN(const auto minute, scan.picture("minute", size + "--only-bounce 1" + seconds(run, 60)));
    LUCARNE_TRY(judge("cornell, bounce 1, high, 60 s", minute, first, .001, .01));

    double whole = 0;
    for (const std::string& n : run.cases<std::string>({"1", "2", "4"})) {
        LUCARNE_ASSIGN(const auto picture, scan.picture("n", size + "--only-bounce 1 --interleave " + n));
        const double mean = gi::mean_luminance(picture);
        if (n == "1") whole = mean;
        row("cornell, bounce 1, high, interleave " + n, "mean against interleave 1", mean / whole - 1, .01,
            true);
    }
    double small = 0;
    for (const std::string& atlas : run.cases<std::string>({"1024", "2048", "4096"})) {
        LUCARNE_ASSIGN(const auto picture, scan.picture("a", run.picture(256, "interactive") +
                                                                 "--only-bounce 1 --atlas " + atlas));
        const double mean = gi::mean_luminance(picture);
        if (atlas == "1024") small = mean;
        row("cornell, bounce 1, interactive, atlas " + atlas, "mean against atlas 1024", mean / small - 1,
            .01, true);
    }
    return soft_lights(scan, "cornell-area", "front", run, .0125);
}

/// Measures the same VPLs on points in another order, and on half and twice as many points.
Result<void> invariance(gi::Device& device, const BenchRun& run) {
    gi::scenes::AnalyticScene scene;
    scene.surfels = gi::scenes::closed_box(2, 100, glm::vec3(0.5f));
    scene.materials = {gi::scenes::material(1, 0, 1, 0.5f)};
    scene.camera =
        gi::scenes::look(glm::vec3(0.3f, 0.4f, 0.5f), glm::vec3(1.2f, 1.3f, 0.9f), 1.0f, side(run, 128));
    scene.settings = high(run);
    LUCARNE_ASSIGN(const auto in_order, gi::scenes::render(device, "vpl", scene));
    std::shuffle(scene.surfels.begin(), scene.surfels.end(), std::mt19937(7));
    LUCARNE_ASSIGN(const auto shuffled, gi::scenes::render(device, "vpl", scene));
    row("closed furnace, points shuffled, high", "mean against in order",
        gi::mean_luminance(shuffled.radiance) / gi::mean_luminance(in_order.radiance) - 1, .01, true);
    double usual = 0;
    for (const int millions : run.cases<int>({2, 1, 4})) {
        LUCARNE_ASSIGN(const Scan scan,
                       Scan::create("cornell", run.points(millions * 1'000'000ull), run.folder));
        LUCARNE_ASSIGN(const auto picture, scan.picture("n", run.picture(256, "high") + "--only-bounce 1"));
        const double mean = gi::mean_luminance(picture);
        if (millions == 2) usual = mean;
        row(fmt::format("cornell, bounce 1, high, {}M points", millions), "mean against 2M points",
            mean / usual - 1, .01, true);
    }
    return {};
}

/// Compares one second of each engine, after the cloud is loaded.
Result<void> equal_time(const BenchRun& run) {
    LUCARNE_ASSIGN(const Scan scan, Scan::create("cornell", run.points(2'000'000), run.folder));
    const std::string common = run.picture(256, "interactive") + "--only-bounce 1 ";
    LUCARNE_ASSIGN(const auto truth, scan.truth("truth", common + samples(run, 1024)));
    LUCARNE_ASSIGN(const auto by_vpl, scan.picture("second", common + seconds(run, 1)));
    LUCARNE_ASSIGN(const auto by_paths,
                   scan.picture("second", common + "--engine reference --samples 1" + seconds(run, 1)));
    LUCARNE_ASSIGN(const auto vpl, gi::compare_with_halves(by_vpl, truth.first, truth.second));
    LUCARNE_ASSIGN(const auto paths, gi::compare_with_halves(by_paths, truth.first, truth.second));
    row("cornell, bounce 1, interactive, 1 s", "relMSE over reference's in 1 s", vpl.rel_mse / paths.rel_mse,
        .1, false);
    return {};
}

Result<void> nave(const BenchRun& run) {
    LUCARNE_ASSIGN(Scan scan, Scan::create("nave", run.points(8'000'000), run.folder));
    for (const std::string& camera : run.cases<std::string>({"nave", "carpet", "aisle", "altar", "vault"})) {
        const std::string common = run.picture(192, "high") + "--bounces 3 --camera " + camera + " ";
        LUCARNE_ASSIGN(const auto truth, scan.truth(camera, common + samples(run, 256)));
        LUCARNE_ASSIGN(const auto picture, scan.picture(camera + "-vpl", common));
        LUCARNE_TRY(judge("nave, " + camera + ", bounces 0 to 3, high", picture, truth, .03, .03));
    }
    return soft_lights(scan, "nave-sky", "nave", run, .03);
}

/// Measures a room that gets its light from a sunlit one, over a shut door: what leaks through walls shows
/// here.
Result<void> dark_room(const BenchRun& run) {
    LUCARNE_ASSIGN(const Scan scan, Scan::create("house", run.points(1'000'000), run.folder, ""));
    for (const std::string& camera : run.cases<std::string>({"dark", "daylight"})) {
        const std::string common = run.picture(96, "high") + "--bounces 3 --camera " + camera + " ";
        LUCARNE_ASSIGN(const auto truth, scan.truth(camera, common + samples(run, 1024)));
        LUCARNE_ASSIGN(const auto picture, scan.picture(camera + "-vpl", common + "--frames 2"));
        row("house, " + camera + ", bounces 0 to 3, high, 2 frames", "mean",
            gi::mean_luminance(picture) / gi::mean_luminance(truth.whole) - 1, camera == "dark" ? .1 : .03,
            true);
    }
    return {};
}

/// Measures one bounce in an entirely glossy Cornell box, averaged for a minute. A path tracer hits lobes by
/// chance; the picture is small, so that the reference can have many paths a pixel.
Result<void> glossy(const BenchRun& run) {
    LUCARNE_ASSIGN(Scan scan, Scan::create("cornell", run.points(2'000'000), run.folder));
    const std::string common = run.picture(64, "high") + "--only-bounce 1 ";
    using Glossy = std::pair<int, int>;  // the lobe's exponent, the reference's paths a pixel
    for (const auto& [exponent, paths] : run.cases<Glossy>({{10, 4096}, {100, 8192}, {1000, 32768}})) {
        scan.light_by(bench::shiny_scene(run, exponent));
        LUCARNE_ASSIGN(const auto truth,
                       scan.truth("truth", common + samples(run, static_cast<uint64_t>(paths))));
        for (const std::string& time : {std::string(), seconds(run, 60)}) {
            LUCARNE_ASSIGN(const auto picture, scan.picture("glossy", common + time));
            const std::string what =
                fmt::format("cornell, shininess {}, high, {}", exponent, time.empty() ? "a frame" : "60 s");
            LUCARNE_ASSIGN(const gi::HalvesError error,
                           gi::compare_with_halves(picture, truth.first, truth.second));
            if (!time.empty()) row(what, "relMSE, unbiased", error.rel_mse, .05, false);
            row(what, "brightest over reference's", brightest(picture) / brightest(truth.whole), 3, false);
            row(what, "energy", gi::mean_luminance(picture) / gi::mean_luminance(truth.whole) - 1, .03, true);
        }
    }
    return {};
}

Result<void> measure(const BenchRun& run) {
    LUCARNE_ASSIGN(const auto device, gi::Device::headless());
    if (run.subject == "micro") return bench::accuracy_of_micro(*device, run);
    if (run.subject == "environment") return bench::accuracy_of_environment(*device, run);
    if (run.subject == "volume") return bench::accuracy_of_volume(*device, run);
    if (run.subject == "paths") return bench::accuracy_of_paths(*device, run);
    LUCARNE_TRY(bench::furnace(*device, run, "vpl", .02, .005));
    LUCARNE_TRY(bench::form_factors(*device, run, "vpl", .02, .005));
    LUCARNE_TRY(cornell(run));
    LUCARNE_TRY(invariance(*device, run));
    LUCARNE_TRY(equal_time(run));
    LUCARNE_TRY(glossy(run));
    LUCARNE_TRY(dark_room(run));
    return nave(run);
}

}  // namespace
}  // namespace lucarne

int main(int argc, char** argv) {
    return lucarne::bench::bench_main(argc, argv, lucarne::measure,
                                      {.subjects = {"micro", "environment", "volume", "paths"}});
}
