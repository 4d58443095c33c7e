// Speed of voxels and of light that crosses them, beside the targets. This is a program and not a test.
// `lucarne_volume [FOLDER] [--scale S]` puts its scans into FOLDER (default: a temporary one, removed
// afterwards).
#include <algorithm>
#include <cstdio>
#include <ctime>
#include <string>
#include <string_view>
#include <thread>
#include <vector>

#include <fmt/format.h>

#include "gi/bounce_options.h"
#include "gi/engines/volume/options.h"
#include "tests/bench/bench_run.h"
#include "tests/bench/quantile.h"
#include "tests/bench/rows.h"
#include "tests/bench/scan.h"
#include "tests/bench/stage.h"
#include "tests/bench/voxel_figures.h"

namespace lucarne {
namespace {

using bench::BenchRun, bench::pass_seconds, bench::Scan, bench::scene_file, bench::Stage;

/// Medians of several runs, ms: on the clock, and of all cores.
struct Times {
    double wall = 0, cpu = 0;
};
template <class Work>
Times times_of(int runs, const Work& work) {
    std::vector<double> wall, cpu;
    for (int i = 0; i < runs; ++i) {
        const std::clock_t start = std::clock();
        wall.push_back(bench::milliseconds_of(work));
        cpu.push_back(1e3 * static_cast<double>(std::clock() - start) / CLOCKS_PER_SEC);
    }
    return {bench::median(wall), bench::median(cpu)};
}

void time_row(const std::string& what, const Times& times, double target) {
    row(what, times.wall, "ms", target);
    figure("  of all cores", times.cpu, "ms");
}

/// Passes of the engine in a picture made anew, on a scan of a million points.
Result<void> bench_light(gi::Device& device, const BenchRun& run) {
    LUCARNE_ASSIGN(const Scan scan, Scan::create("cornell", run.points(1'000'000), run.folder));
    Stage stage(device, scan);
    LUCARNE_TRY(
        stage.open({.scene = scene_file("cornell"), .size = run.size({512, 512}), .preset = "interactive"}));
    gi::EngineSettings settings = stage.settings();
    settings.set(gi::kBounces, 2);
    const auto passes = [&](uint32_t voxels) -> Result<Stage::Picture> {
        settings.set(gi::volume::kVoxelCount, voxels);
        settings.set(gi::volume::kVolumeLevels, 1);      // each further level takes about as long again
        LUCARNE_TRY(stage.picture("direct", settings));  // so that the engine is made anew
        return stage.picture("volume", settings);
    };
    for (const uint32_t voxels : {32u, 64u}) {
        LUCARNE_ASSIGN(const Stage::Picture picture, passes(voxels));
        const auto pass = [&](std::string_view name) { return 1e3 * pass_seconds(picture.last, name); };
        if (voxels == 64) {
            row("voxels of 1M surfels, 64^3", pass("voxels"), "ms", 45);
            figure("  their faces", pass("faces"), "ms");
            row("first bounce, 64^3", pass("first bounce"), "ms", 40);
        }
        row(fmt::format("a sweep of 64 directions, {0}^3", voxels), pass("sweep"), "ms",
            voxels == 32 ? 20 : 150);
    }
    settings.set(gi::volume::kTransport, gi::volume::Transport::sh);
    settings.set(gi::volume::kIterations, 64u);
    settings.set(gi::kBounces, 1);
    LUCARNE_ASSIGN(const Stage::Picture sh, passes(32));
    row("64 iterations of spherical harmonics, 32^3", 1e3 * pass_seconds(sh.last, "propagation"), "ms", 60);

    settings = stage.settings();
    settings.set(gi::kBounces, 2);
    settings.set(gi::volume::kVoxelCount, 64u);
    settings.set(gi::volume::kTransport, gi::volume::Transport::sweeps);
    stage.request().moving = true;
    LUCARNE_TRY(stage.pipeline().set_engine("volume"));
    LUCARNE_TRY(stage.frames(settings, 1));
    LUCARNE_ASSIGN(const auto moving, stage.frames_after(run.frames(9), [&](int) -> Result<void> {
        stage.request().camera.position.x += 0.001;
        return {};
    }));
    time_row("512x512, the camera moves, lights still", {moving.milliseconds, moving.processor}, 100);
    return {};
}

/// Updates of voxels by pictures, and triangles divided among voxels.
Result<void> bench_voxels(gi::Device& device, const BenchRun& run) {
    LUCARNE_ASSIGN(const bench::VoxelModel model, bench::knot_model());
    LUCARNE_ASSIGN(bench::Tour tour, bench::Tour::create(device, model, run, run.side(512)));
    const uint32_t voxels = run.trial() ? 32 : 128;
    for (const bool fused : {false, true}) {
        gi::volume::ImageVoxels window = bench::window_about(model, voxels);
        constexpr int kTurn = 8;
        for (int i = 0; i < 3 * kTurn; ++i) {
            LUCARNE_ASSIGN(const auto image, tour.take(i, kTurn));
            window.update({&image, 1}, {.fused = fused});
        }
        LUCARNE_ASSIGN(const auto image, tour.take(0, kTurn));
        const gi::volume::ImageUpdate how{.samples = 2 * voxels, .fused = fused};
        time_row(fused ? "voxels updated by a picture, 128^3, fused" : "voxels updated by a picture, 128^3",
                 times_of(run.frames(9),
                          [&] {
                              window.update({&image, 1}, how);
                          }),
                 5);
    }
    LUCARNE_ASSIGN(const auto triangles, gi::volume::MeshTriangles::create(model.mesh, 1, voxels));
    const Times area = times_of(run.frames(3), [&] { gi::volume::areas_of_triangles(triangles); });
    figure("80 thousand triangles by exact areas, 128^3", area.wall, "ms");
    figure("  of all cores", area.cpu, "ms");
    for (const auto slicing : {gi::volume::Slicing::cut, gi::volume::Slicing::discard}) {
        Result<gi::volume::VoxelSet> set;
        const Times drawn = times_of(run.frames(3), [&] {
            set = gi::volume::rasterize_triangles(device, triangles, {.slicing = slicing});
        });
        if (!set) return tl::make_unexpected(set.error());
        figure(fmt::format("  drawn by {}", slicing == gi::volume::Slicing::cut ? "geometry" : "slices"),
               drawn.wall, "ms");
    }
    return {};
}

Result<void> measure(const BenchRun& run) {
    LUCARNE_ASSIGN(const auto device, gi::Device::headless());
    fmt::print("{}; {} hardware threads\n", device->info().renderer, std::thread::hardware_concurrency());
    LUCARNE_TRY(bench_voxels(*device, run));
    return bench_light(*device, run);
}

}  // namespace
}  // namespace lucarne

int main(int argc, char** argv) {
    return lucarne::bench::bench_main(argc, argv, lucarne::measure);
}
