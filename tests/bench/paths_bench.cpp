// Speed and memory of light paths that are computed in advance, beside the targets. This is a program and not
// a test. `lucarne_paths [FOLDER] [--scale S]` puts its scans into FOLDER (default: a temporary one, removed
// afterwards).
#include <cstdio>
#include <filesystem>
#include <string>
#include <string_view>
#include <thread>

#include <fmt/format.h>

#include "gi/bounce_options.h"
#include "gi/scene/scene.h"
#include "tests/bench/bench_run.h"
#include "tests/bench/quantile.h"
#include "tests/bench/rows.h"
#include "tests/bench/scan.h"
#include "tests/bench/stage.h"

namespace lucarne {
namespace {

using bench::BenchRun, bench::pass_seconds, bench::Scan, bench::scene_file, bench::Stage;

constexpr uint32_t kBounces = 4;

std::string preset(const BenchRun& run) {
    return run.trial() ? "preview" : "interactive";
}

/// Computes the paths of a scan in a process of its own.
Result<void> bench_preparation(const Scan& scan, const BenchRun& run) {
    Result<Usage> used;
    const double milliseconds = bench::milliseconds_of([&] {
        used = run_lucarne({"prepare", scan.cache(), "--engine", "paths", "--preset", preset(run)});
    });
    if (!used) return tl::make_unexpected(used.error());
    row("preparation of the nave", 1e-3 * milliseconds, "s", 30);
    figure("  of all cores", used->cpu_seconds, "s");
    figure("  peak memory of the process", used->peak_mebibytes, "MiB");
    const std::filesystem::path bake = scan.cache() + ".paths.bake";
    std::error_code error;
    const auto bytes = std::filesystem::file_size(bake, error);
    if (error) return failed(bake.string(), "was not made");
    row("  on disk", 1e-6 * static_cast<double>(bytes), "MB", 60);
    return {};
}

/// Prints what the light of a frame took, without what direct light takes as well.
void print_relight(const std::string& what, const Stage::Measured& frame, double target) {
    double sum = 0;
    for (const std::string_view pass :
         {"entry points", "photon energies", "bounces", "final gathering", "light by direction"}) {
        const double milliseconds = 1e3 * pass_seconds(frame.last, pass);
        sum += milliseconds;
        if (milliseconds > 0) figure(fmt::format("  {}", pass), milliseconds, "ms");
    }
    row(what, sum, "ms", target);
}

/// Measures changes of light and of the camera in a scan whose paths are known.
Result<void> bench_frames(gi::Device& device, const Scan& scan, const BenchRun& run) {
    Stage stage(device, scan);
    LUCARNE_TRY(
        stage.open({.scene = scene_file("nave"), .size = run.size({512, 512}), .preset = preset(run)}));
    gi::EngineSettings settings = stage.settings();
    settings.set(gi::kBounces, kBounces);
    const auto glide = [&](int) -> Result<void> {
        stage.request().moving = true;  // by shadow maps, as in the window
        stage.request().camera.position.x += .001;
        return {};
    };
    const auto move_lamp = [&](int) -> Result<void> {
        gi::Scene scene = stage.pipeline().scene();
        scene.lights.at(0).position.x += .01;
        return stage.pipeline().set_scene(std::move(scene));
    };
    const auto dim = [&](int) -> Result<void> {
        gi::Scene scene = stage.pipeline().scene();
        for (gi::SceneMaterial& material : scene.materials) material.diffuse *= .99;
        return stage.pipeline().set_scene(std::move(scene));
    };
    double direct = 0, direct_cpu = 0;
    for (const std::string engine : {"direct", "paths"}) {
        LUCARNE_TRY(stage.pipeline().set_engine(engine));
        LUCARNE_TRY(stage.frames(settings, 1));  // loads, and reads the paths
        LUCARNE_ASSIGN(const auto moved, stage.frames_after(run.frames(9), glide));
        if (engine == "direct") {
            direct = moved.milliseconds, direct_cpu = moved.processor;
            figure("512x512, direct light, the camera moves", direct, "ms");
            continue;
        }
        row("512x512, paths, the camera moves: beyond direct light", moved.milliseconds - direct, "ms", 20);
        figure("  of all cores", moved.processor - direct_cpu, "ms");
    }
    stage.request().moving = false;
    LUCARNE_ASSIGN(const auto edited, stage.frames_after(run.frames(5), dim));
    print_relight("materials edited: light anew, four bounces", edited, 120);
    LUCARNE_ASSIGN(const auto at_rest, stage.frames_after(run.frames(5), move_lamp));
    figure("512x512, another lamp, at rest, by rays: a frame", at_rest.milliseconds, "ms");
    stage.request().moving = true;  // as in the window, where a lamp that is dragged is motion
    LUCARNE_ASSIGN(const auto lamp, stage.frames_after(run.frames(5), move_lamp));
    print_relight("a lamp moves: light anew, four bounces", lamp, 120);
    row("512x512, a lamp moves, four bounces: a frame", lamp.milliseconds, "ms", 280);
    figure("  of all cores", lamp.processor, "ms");
    return {};
}

Result<void> measure(const BenchRun& run) {
    LUCARNE_ASSIGN(const auto device, gi::Device::headless());
    fmt::print("{}; {} hardware threads\n", device->info().renderer, std::thread::hardware_concurrency());
    LUCARNE_ASSIGN(const Scan scan, Scan::create("nave", run.points(1'000'000), run.folder));
    LUCARNE_TRY(bench_preparation(scan, run));
    return bench_frames(*device, scan, run);
}

}  // namespace
}  // namespace lucarne

int main(int argc, char** argv) {
    return lucarne::bench::bench_main(argc, argv, lucarne::measure);
}
