// Measures every figure that the project has a target for (speed and memory) and prints it beside the target.
// This is a program and not a test, so that it does not fail on a busy machine. `lucarne_bench [FOLDER]
// [--scale S]` puts its scans into FOLDER (default: a temporary one, removed afterwards; it needs 4 GB).
#include <algorithm>
#include <cstdio>
#include <ctime>
#include <filesystem>
#include <fstream>
#include <string>
#include <thread>
#include <vector>

#include <fmt/format.h>
#include <nlohmann/json.hpp>

#include "gi/bounce_options.h"
#include "gi/raster/gbuffer.h"
#include "gi/scene/views.h"
#include "tests/bench/conversion.h"
#include "tests/bench/formats.h"
#include "tests/bench/quantile.h"
#include "tests/io/io_testing.h"
#include "viewer/commands/options/drawing_options.h"
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
    double slow = 0;           ///< 95 % of the frames take at most this wall time, ms
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
    times.slow = bench::quantile(wall, .95);
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
    LUCARNE_ASSIGN(const viewer::SceneForScan loaded, viewer::load_scene_for(options, *source));
    viewer::FrameRequest request;
    request.wait = true;
    LUCARNE_ASSIGN(request.camera, viewer::find_camera(loaded.scene, ""));
    LUCARNE_ASSIGN(auto pipeline, viewer::open_pipeline(*device, source, options, drawing, loaded.scene));

    request.size = run.size({512, 512});
    LUCARNE_TRY(moving_frames(*pipeline, request, 2, ""));  // warm-up: shaders, first loads
    const auto frames = [&](const std::string& what, uint32_t bounces, bool anew,
                            double target) -> Result<void> {
        gi::EngineSettings settings = pipeline->settings();
        settings.set(gi::kBounces, bounces);
        pipeline->set_settings(settings);
        LUCARNE_TRY(moving_frames(*pipeline, request, 2, ""));
        LUCARNE_ASSIGN(const FrameTimes times, moving_frames(*pipeline, request, run.frames(9), "", anew));
        row("512x512, preset interactive, " + what, times.wall, "ms", target);
        fmt::print("  of all cores: {:.0f} ms; the last frame's passes in ms:", times.cpu);
        for (const auto& entry : times.last.passes)
            fmt::print(" {} {:.0f},", entry.name, 1e3 * entry.seconds);
        fmt::print("\n");
        return {};
    };
    LUCARNE_TRY(frames("one bounce, VPLs anew", 1, true, 150));
    LUCARNE_TRY(frames("one bounce, the camera moves", 1, false, 90));
    LUCARNE_TRY(frames("three bounces, VPLs anew", 3, true, 350));
    LUCARNE_TRY(frames("three bounces, the camera moves", 3, false, 120));

    // As in the window: new light in every frame, of which each makes a part.
    request.moving = true;
    request.light_budget = gi::StepBudget::timed(.03);
    LUCARNE_TRY(moving_frames(*pipeline, request, 2, ""));
    LUCARNE_ASSIGN(const FrameTimes in_motion, moving_frames(*pipeline, request, run.frames(40), "", true));
    row("512x512, preset interactive, three bounces, light in steps", in_motion.wall, "ms", 120);
    row("the same, 95 % of the frames", in_motion.slow, "ms", 150);
    request.moving = false;
    request.light_budget = {};

    LUCARNE_TRY(pipeline->set_engine("direct"));
    pipeline->set_budgets(
        {.view = 5'000'000, .light_view = 100'000, .light = 100'000, .pixel_spacing = 1e-3});
    request.size = run.size({1280, 720});
    LUCARNE_TRY(moving_frames(*pipeline, request, 2, ""));
    LUCARNE_ASSIGN(const FrameTimes gbuffer, moving_frames(*pipeline, request, run.frames(9), "G-buffer"));
    LUCARNE_ASSIGN(const FrameTimes blending, moving_frames(*pipeline, request, run.frames(9), "blending"));
    const std::string what = fmt::format("{:.2f}M surfels into a 1280x720 G-buffer",
                                         1e-6 * static_cast<double>(gbuffer.last.view_points));
    row(what, gbuffer.wall, "ms", 50);
    row(what + ", blended", gbuffer.wall + blending.wall, "ms", 90);
    std::filesystem::remove(cache);
    return {};
}

/// Renders a still of a real room by sun and sky.
Result<void> bench_still(const bench::BenchRun& run) {
    const std::string what = "a loft (a real scan), sun and sky, high, three bounces, 640x400";
    const std::filesystem::path scan = io::testing::shared_data() / "interiors/loft.laz";
    if (!std::filesystem::exists(scan)) {
        row_missing(what, "the scan is missing");
        return {};
    }
    const std::string cache = run.folder / "loft.luc", scene = run.folder / "loft.json";
    const std::string report = run.folder / "loft-report.json", picture = run.folder / "loft.png";
    std::ofstream(scene) << R"({"environment": {"radiance": [60, 75, 95]}, "exposure": {"ev": -2.5},
        "lights": [{"type": "directional", "direction": [0.55, 0.45, -0.7], "irradiance": [900, 820, 700]}],
        "cameras": [{"name": "a", "position": [3, 3, 2.4], "target": [12, 8, 2], "fov": 75}]})";
    LUCARNE_TRY(run_lucarne({"convert", scan.string(), "-o", cache, "--overwrite"}));
    LUCARNE_ASSIGN(const Usage used, run_lucarne({"render", cache, "--scene", scene, "--size",
                                                  run.trial() ? "32x20" : "640x400", "--preset",
                                                  run.trial() ? "preview" : "high", "--bounces", "3", "-o",
                                                  picture, "--json", report, "--overwrite"}));
    std::ifstream in(report);
    row(what, nlohmann::json::parse(in).at("last_frame_seconds").get<double>(), "s", 8);
    figure(what + ", CPU", used.cpu_seconds, "s");
    return {};
}

Result<void> measure(const bench::BenchRun& run) {
    fmt::print("{} hardware threads\n", std::thread::hardware_concurrency());
    LUCARNE_TRY(bench_frames(run));
    LUCARNE_TRY(bench_still(run));
    LUCARNE_TRY(bench_normals(run));
    if (run.trial()) return {};  // bench_formats and bench_convert run these as well
    LUCARNE_TRY(bench::bench_formats(run));
    return bench_conversion(run);
}

}  // namespace
}  // namespace lucarne

int main(int argc, char** argv) {
    return lucarne::bench::bench_main(argc, argv, lucarne::measure);
}
