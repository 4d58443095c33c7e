// Measures every figure that the project has a target for (speed and memory) and prints it beside the target.
// This is a program and not a test, so that it does not fail on a busy machine. `lucarne_bench [FOLDER]
// [--scale S]` puts its scans into FOLDER (default: a temporary one, removed afterwards; it needs 4 GB).
#include <algorithm>
#include <cstdio>
#include <ctime>
#include <filesystem>
#include <string>
#include <thread>
#include <vector>

#include <fmt/format.h>

#include "gi/bounce_options.h"
#include "gi/raster/gbuffer.h"
#include "tests/bench/conversion.h"
#include "tests/bench/formats.h"
#include "tests/bench/quantile.h"
#include "viewer/commands/options/drawing_options.h"
#include "viewer/frame/views.h"
#include "viewer/inputs/input.h"

namespace lucarne {
namespace {

Result<void> bench_normals(const bench::BenchRun& run) {
    const uint64_t points = run.points(4'000'000);
    const std::string scan = run.folder / "nave4m.las", cache = run.folder / "nave4m.luc";
    LUCARNE_TRY(
        run_lucarne({"generate", "nave", "-o", scan, "--points", std::to_string(points), "--overwrite"}));
    LUCARNE_ASSIGN(const Usage without,
                   run_lucarne({"convert", scan, "-o", cache, "--normals", "none", "--overwrite"}));
    LUCARNE_ASSIGN(const Usage with,
                   run_lucarne({"convert", scan, "-o", cache, "--normals", "estimate", "--overwrite"}));
    row("normals and areas of 4M points, CPU per million",
        (with.cpu_seconds - without.cpu_seconds) * 1e6 / static_cast<double>(points), "s", 1);
    std::filesystem::remove(scan);
    return {};
}

struct FrameTimes {
    double wall = 0, cpu = 0;  ///< medians, ms; `cpu` is the time of all cores over the whole frame
    viewer::FrameStats last;
};

/// Draws frames with a moving camera, as a user sees them. `pass` selects the measured pass. With `anew` a
/// frame reuses nothing of the one before.
Result<FrameTimes> moving_frames(viewer::Pipeline& pipeline, viewer::FrameRequest request, int frames,
                                 std::string_view pass, bool anew = false) {
    std::vector<double> wall, cpu;
    FrameTimes times;
    for (int i = 0; i < frames; ++i) {
        request.camera.position.x += 0.01;
        if (anew) {
            gi::EngineSettings settings = pipeline.settings();
            settings.set(gi::kSeed, settings[gi::kSeed] + 1);
            pipeline.set_settings(settings);
        }
        const std::clock_t start = std::clock();
        LUCARNE_ASSIGN(times.last, pipeline.render(request));
        cpu.push_back(1e3 * static_cast<double>(std::clock() - start) / CLOCKS_PER_SEC);
        double seconds = pass.empty() ? times.last.seconds : 0;
        for (const auto& entry : times.last.passes)
            if (entry.name == pass) seconds += entry.seconds;
        wall.push_back(1e3 * seconds);
    }
    times.wall = bench::median(wall);
    times.cpu = bench::median(cpu);
    return times;
}

Result<void> bench_frames(const bench::BenchRun& run) {
    const std::string scan = run.folder / "even.ply", cache = run.folder / "even.luc";
    LUCARNE_TRY(run_lucarne({"generate", "nave", "-o", scan, "--points",
                             std::to_string(run.points(8'000'000)), "--even", "--normals", "--overwrite"}));
    LUCARNE_TRY(run_lucarne({"convert", scan, "-o", cache, "--normals", "keep", "--overwrite"}));
    std::filesystem::remove(scan);
    LUCARNE_ASSIGN(const auto device, gi::Device::headless());
    LUCARNE_ASSIGN(const auto source, viewer::open_input(cache));
    viewer::DrawingOptions options;
    options.scene = LUCARNE_SOURCE_DIR "/data/scenes/nave.json";
    LUCARNE_TRY(viewer::take_render_settings(options));
    LUCARNE_ASSIGN(viewer::Drawing drawing, viewer::resolve(options));
    LUCARNE_ASSIGN(gi::Scene scene, viewer::load_scene_for(options, *source));
    viewer::FrameRequest request;
    request.wait = true;
    LUCARNE_ASSIGN(request.camera, viewer::find_camera(scene, ""));
    LUCARNE_ASSIGN(auto pipeline, viewer::open_pipeline(*device, source, options, drawing, scene));

    request.size = {512, 512};
    LUCARNE_TRY(moving_frames(*pipeline, request, 2, ""));  // warm-up: shaders, first loads
    const auto frames = [&](const std::string& what, uint32_t bounces, bool anew,
                            double target) -> Result<void> {
        gi::EngineSettings settings = pipeline->settings();
        settings.set(gi::kBounces, bounces);
        pipeline->set_settings(settings);
        LUCARNE_TRY(moving_frames(*pipeline, request, 2, ""));
        LUCARNE_ASSIGN(const FrameTimes times, moving_frames(*pipeline, request, 9, "", anew));
        row("512x512, preset interactive, " + what, times.wall, "ms", target);
        fmt::print("  of all cores: {:.0f} ms; the last frame's passes in ms:", times.cpu);
        for (const auto& entry : times.last.passes)
            fmt::print(" {} {:.0f},", entry.name, 1e3 * entry.seconds);
        fmt::print("\n");
        return {};
    };
    LUCARNE_TRY(frames("one bounce, VPLs anew", 1, true, 600));
    LUCARNE_TRY(frames("one bounce, the camera moves", 1, false, 200));
    LUCARNE_TRY(frames("three bounces, VPLs anew", 3, true, 500));
    LUCARNE_TRY(frames("three bounces, the camera moves", 3, false, 500));

    LUCARNE_TRY(pipeline->set_engine("direct"));
    pipeline->set_budgets(
        {.view = 5'000'000, .light_view = 100'000, .light = 100'000, .pixel_spacing = 1e-3});
    request.size = {1280, 720};
    LUCARNE_TRY(moving_frames(*pipeline, request, 2, ""));
    LUCARNE_ASSIGN(const FrameTimes gbuffer, moving_frames(*pipeline, request, 9, "G-buffer"));
    row(fmt::format("{:.2f}M surfels into a 1280x720 G-buffer",
                    1e-6 * static_cast<double>(gbuffer.last.view_points)),
        gbuffer.wall, "ms", 100);
    std::filesystem::remove(cache);
    return {};
}

Result<void> measure(const bench::BenchRun& run) {
    fmt::print("{} hardware threads\n", std::thread::hardware_concurrency());
    LUCARNE_TRY(bench_frames(run));
    LUCARNE_TRY(bench_normals(run));
    LUCARNE_TRY(bench::bench_formats(run));
    return bench_conversion(run);
}

}  // namespace
}  // namespace lucarne

int main(int argc, char** argv) {
    return lucarne::bench::bench_main(argc, argv, lucarne::measure);
}
