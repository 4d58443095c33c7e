// Speed and memory of the engines that gather light, `micro` and `environment`, beside their targets, and the
// rate of Embree's rays in the same run. This is a program and not a test. `lucarne_gather [FOLDER] [--scale
// S]` puts its scans into FOLDER (default: a temporary one, removed afterwards).
#include <algorithm>
#include <atomic>
#include <cstdio>
#include <ctime>
#include <string>
#include <string_view>
#include <thread>
#include <vector>

#include <fmt/format.h>

#include "gi/bounce_options.h"
#include "gi/device/cl/cl_device.h"
#include "gi/gather/gather_options.h"
#include "gi/host_frame.h"
#include "gi/shared/brdf.h"
#include "gi/tracing/scatter.h"
#include "gi/tracing/surfel_tracer.h"
#include "io/core/parallel.h"
#include "io/core/random.h"
#include "tests/bench/all_surfels.h"
#include "tests/bench/bench_run.h"
#include "tests/bench/rows.h"
#include "tests/bench/scan.h"
#include "tests/bench/stage.h"

namespace lucarne {
namespace {

using bench::BenchRun, bench::pass_seconds, bench::Scan, bench::scene_file, bench::Stage, bench::statistic;

/// Prints the passes of the last frame that take longer than a millisecond, and the time of all cores.
void print_passes(const Stage::Measured& measured) {
    fmt::print("  of all cores: {:.2f} s; the last frame's passes in ms:", 1e-3 * measured.processor);
    for (const auto& pass : measured.last.passes)
        if (pass.seconds > 1e-3) fmt::print(" {} {:.0f},", pass.name, 1e3 * pass.seconds);
    fmt::print("\n");
    std::fflush(stdout);
}

std::string preset(const BenchRun& run, const std::string& full) {
    return run.trial() ? "preview" : full;
}

/// Returns how many rays a second of one core Embree finds the nearest surfel for: from the points that a
/// stage shows, cosine-distributed, as in the reference.
Result<double> embree_rays(gi::Device& device, const Scan& scan, Stage& stage, const BenchRun& run) {
    LUCARNE_ASSIGN(auto surfels, bench::all_surfels(device, scan.cache()));
    LUCARNE_ASSIGN(const auto tracer, gi::tracing::SurfelTracer::create(std::move(surfels)));
    const glm::vec3 origin(stage.pipeline().local_origin());
    const gi::GBuffer& seen = stage.pipeline().gbuffer();
    const auto surfaces =
        gi::visible_surfaces(stage.pipeline().camera(),
                             seen.texels.download_all<gi::GBufferTexel>(size_t{seen.width} * seen.height));
    constexpr size_t kEvery = 16;  // pixels
    const uint64_t rays = run.count(64);
    const gi::Reflectance white{.kd = glm::vec3(1.0f), .ks = 0, .exponent = 1};
    std::atomic<uint64_t> cast = 0;
    const std::clock_t start = std::clock();
    parallel_ranges(surfaces.size() / kEvery, 256, [&](size_t first, size_t last) {
        uint64_t own = 0;
        for (size_t i = first; i < last; ++i) {
            const size_t pixel = i * kEvery;
            const gi::SurfacePoint& at = surfaces[pixel];
            if (!(at.radius > 0)) continue;
            const glm::vec3 from = gi::tracing::offset_origin(origin + at.position, at.normal, at.radius);
            Random random(1, pixel);
            for (uint64_t ray = 0; ray < rays; ++ray)
                if (const auto to = gi::tracing::scatter(white, at.normal, at.viewer, random)) {
                    tracer->nearest(from, to->direction);
                    ++own;
                }
        }
        cast += own;
    });
    const double seconds = static_cast<double>(std::clock() - start) / CLOCKS_PER_SEC;
    return static_cast<double>(cast) / std::max(seconds, 1e-6);
}

/// Measures `micro` at every pixel and at every 16th, 24 x 24 directions each.
Result<void> bench_micro(gi::Device& device, const BenchRun& run, const std::string& scene, double target) {
    LUCARNE_ASSIGN(const Scan scan, Scan::create(scene, run.points(1'000'000), run.folder));
    Stage stage(device, scan);
    LUCARNE_TRY(stage.open(
        {.scene = scene_file(scene), .size = run.size({512, 512}), .preset = preset(run, "high")}));
    LUCARNE_TRY(stage.pipeline().set_engine("micro"));
    gi::EngineSettings settings = stage.settings();
    settings.set(gi::kOnlyBounce, 1);
    settings.set(gi::kMicroBuffer, 24);
    for (const uint32_t every : {4u, 1u}) {
        settings.set(gi::kGatherEvery, every);
        if (every > 1) LUCARNE_TRY(stage.frames(settings, 1));  // the tree, the kernels, first loads
        LUCARNE_ASSIGN(const auto measured, stage.frames(settings, every > 1 ? run.frames(5) : 1));
        const double points = statistic(measured.last, "gather_points");
        const std::string what = fmt::format("{}, 512x512, {} of the pixels, 24x24 directions, gather", scene,
                                             every == 1 ? "all" : "1/16");
        row(what, pass_seconds(measured.last, "gather") + pass_seconds(measured.last, "upsample"), "s",
            every > 1 ? .3 : target);
        print_passes(measured);
        if (every > 1) continue;
        const double samples = 24 * 24 * points / (1e-3 * measured.processor);
        figure(fmt::format("{}, samples of the gather a CPU-second", scene), 1e-6 * samples, "million");
        LUCARNE_ASSIGN(const double rays, embree_rays(device, scan, stage, run));
        figure(fmt::format("{}, rays of Embree a CPU-second", scene), 1e-6 * rays, "million");
        row_at_least(scene + ", samples of the gather over rays of Embree", samples / rays, "times", 20);
    }
    return {};
}

/// Measures `micro` and `environment` as in a window whose camera moves, and `environment` under a moving
/// sun.
Result<void> bench_frames(gi::Device& device, const BenchRun& run) {
    LUCARNE_ASSIGN(const Scan scan, Scan::create("nave", run.points(1'000'000), run.folder));
    Stage stage(device, scan);
    const auto open = [&](const std::string& scene, const std::string& engine) -> Result<void> {
        LUCARNE_TRY(stage.open({.scene = scene_file(scene),
                                .size = run.size({1280, 720}),
                                .preset = preset(run, "interactive")}));
        LUCARNE_TRY(stage.pipeline().set_engine(engine));
        gi::EngineSettings settings = stage.settings();
        settings.set(gi::kBounces, 1);
        LUCARNE_TRY(stage.frames(settings, 1));  // the tree, the kernels, first loads
        return {};
    };
    const auto glide = [&](int) -> Result<void> {
        stage.request().camera.position.x += 0.01;
        return {};
    };
    LUCARNE_TRY(open("nave", "micro"));
    LUCARNE_ASSIGN(const auto micro, stage.frames_after(run.frames(3), glide));
    figure("micro, nave, 1280x720, interactive, one bounce, the camera moves", 1e-3 * micro.milliseconds,
           "s");
    print_passes(micro);

    LUCARNE_TRY(open("nave-sky", "environment"));
    LUCARNE_ASSIGN(const auto moving, stage.frames_after(run.frames(3), glide));
    row("environment, nave-sky, 1280x720, interactive, the camera moves", 1e-3 * moving.milliseconds, "s",
        .6);
    print_passes(moving);
    LUCARNE_ASSIGN(const auto sunny, stage.frames_after(run.frames(3), [&](int) -> Result<void> {
        gi::Scene scene = stage.pipeline().scene();
        for (gi::SceneLight& light : scene.lights) light.target.x += .01;
        return stage.pipeline().set_scene(std::move(scene));
    }));
    row("the same, only the sun moves", 1e-3 * sunny.milliseconds, "s", .3);
    print_passes(sunny);
    return {};
}

/// Measures the memory that a surfel takes beyond what `direct` needs: from the peaks of two sizes, so that
/// what every process takes cancels out. On a processor OpenCL's buffers count as well.
Result<void> bench_memory(const BenchRun& run) {
    const std::vector<std::string> engines = {"direct", "micro", "environment"};
    std::vector<double> megabytes(engines.size());  // the larger scan's less the smaller's
    double millions = 0;                            // likewise
    for (const uint64_t points : {run.points(500'000), run.points(2'000'000)}) {
        LUCARNE_ASSIGN(const Scan scan, Scan::create("nave", points, run.folder));
        millions = 1e-6 * static_cast<double>(points) - millions;
        for (size_t i = 0; i < engines.size(); ++i) {
            LUCARNE_ASSIGN(
                const Usage used,
                run_lucarne({"render", scan.cache(), "--scene", scene_file("nave"), "--size", "64x64",
                             "--preset", preset(run, "high"), "--bounces", "1", "--engine", engines[i], "-o",
                             run.folder / "memory.png", "--overwrite"}));
            megabytes[i] = 1.048576 * used.peak_mebibytes - megabytes[i];
        }
    }
    for (size_t i = 1; i < engines.size(); ++i)
        row(engines[i] + ", peak memory beyond that of direct, for a million surfels",
            (megabytes[i] - megabytes[0]) / std::max(millions, 1e-6), "MB", 190);
    return {};
}

Result<void> measure(const BenchRun& run) {
    LUCARNE_ASSIGN(const auto device, gi::Device::headless());
    LUCARNE_ASSIGN(gi::ClDevice* const opencl, device->opencl());
    fmt::print("{}; {} hardware threads\n", opencl->info().name, std::thread::hardware_concurrency());
    LUCARNE_TRY(bench_micro(*device, run, "cornell", 4));
    LUCARNE_TRY(bench_micro(*device, run, "nave", 7));
    LUCARNE_TRY(bench_frames(*device, run));
    return bench_memory(run);
}

}  // namespace
}  // namespace lucarne

int main(int argc, char** argv) {
    return lucarne::bench::bench_main(argc, argv, lucarne::measure);
}
