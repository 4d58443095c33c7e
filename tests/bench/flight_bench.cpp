// Measures out-of-core global illumination at full size and prints a table: `lucarne_headline [FOLDER]
// [--scale S]`. Makes a virtual scan of 40M points once in FOLDER (default: a temporary one that is removed;
// 5 GB). Flies through it with three bounces under caps of 128 MiB, a twelfth of the cache; then with the
// whole cloud on the device, at the same places; then slowly, to measure flicker. This is a program and not a
// test: it prints missed targets.
#include <algorithm>
#include <cmath>
#include <cstdio>
#include <cstdlib>
#include <filesystem>
#include <string>
#include <vector>

#include <fmt/format.h>

#include "gi/bounce_options.h"
#include "gi/engines/vpl/options.h"
#include "tests/bench/bench_run.h"
#include "viewer/commands/options/drawing_options.h"
#include "viewer/flythrough/flight.h"
#include "viewer/inputs/input.h"

namespace lucarne {
namespace {

constexpr uint64_t kCap = uint64_t{128} << 20;
constexpr const char* kScene = LUCARNE_SOURCE_DIR "/data/scenes/nave.json";
constexpr const char* kPath = LUCARNE_SOURCE_DIR "/data/flythroughs/nave.json";

void row(const std::string& what, double value, const std::string& unit, double target) {
    fmt::print("{:<66} {:>9.2f} {:<4} target {:>6.4g}  {}\n", what, value, unit, target,
               std::abs(value) <= target ? "kept" : "MISSED");
    std::fflush(stdout);
}
void figure(const std::string& what, double value, const std::string& unit) {
    fmt::print("{:<66} {:>9.2f} {}\n", what, value, unit);
    std::fflush(stdout);
}

Result<std::string> cache_in(const bench::BenchRun& run) {
    const uint64_t points = run.points(40'000'000);
    const std::string cache = run.folder / fmt::format("nave-{}.luc", points), scan = cache + ".ply";
    if (std::filesystem::exists(cache)) return cache;
    for (const std::string& arguments :
         {fmt::format("generate nave --even --normals --points {} --overwrite -o {}", points, scan),
          "convert " + scan + " -o " + cache})
        if (std::system((LUCARNE_BINARY " " + arguments).c_str()) != 0) return failed(arguments, "failed");
    std::filesystem::remove(scan);
    return cache;
}

struct Flown {
    std::vector<viewer::FlownFrame> frames;

    double luminance() const {
        double sum = 0;
        for (const auto& frame : frames) sum += *frame.luminance;
        return sum / static_cast<double>(frames.size());
    }
    double flicker() const {
        double sum = 0;
        for (const auto& frame : frames)
            if (frame.flicker) sum += frame.flicker->change;
        return sum / static_cast<double>(frames.size() - 1);
    }
    /// Returns the maximum of a member of MemoryUse over frames [first, end), MiB.
    double most(uint64_t viewer::MemoryUse::*member, size_t first, size_t end) const {
        uint64_t most = 0;
        for (size_t i = first; i < end; ++i) most = std::max(most, frames[i].stats.memory.*member);
        return static_cast<double>(most) / 1048576;
    }
    double most(uint64_t viewer::MemoryUse::*member) const { return most(member, 0, frames.size()); }
};

struct Way {
    double frames_per_second = 1, seconds = 13;
    bool wait = true;
    ImageSize size{384, 216};
};

/// Flies with a new device.
template <class Change>
Result<Flown> fly(const std::string& cache, const Way& way, const viewer::PipelineOptions& caps,
                  const Change& change) {
    LUCARNE_ASSIGN(const auto device, gi::Device::headless());
    LUCARNE_ASSIGN(const auto source, viewer::open_input(cache));
    viewer::DrawingOptions options;
    options.scene = kScene;
    LUCARNE_TRY(viewer::take_render_settings(options));
    LUCARNE_ASSIGN(viewer::Drawing drawing, viewer::resolve(options));
    LUCARNE_ASSIGN(viewer::SceneForScan loaded, viewer::load_scene_for(options, *source));
    drawing.caps = caps;
    drawing.preset.engine.set(gi::kBounces, 3);
    change(drawing.preset);
    LUCARNE_ASSIGN(const auto pipeline,
                   viewer::open_pipeline(*device, source, options, drawing, std::move(loaded.scene)));
    LUCARNE_ASSIGN(viewer::CameraPath path, viewer::load_path(kPath));
    path.frames_per_second = way.frames_per_second;
    while (path.keys.size() > 2 && path.keys.back().time > way.seconds) path.keys.pop_back();
    // A trial flies three frames.
    path.keys.back().time = std::min(path.keys.back().time, std::max(way.seconds, 2 / way.frames_per_second));
    const viewer::FlightOptions how{.size = way.size, .wait = way.wait, .flicker = true};
    LUCARNE_ASSIGN(viewer::Flight flight, viewer::fly(*pipeline, path, how));
    return Flown{std::move(flight.frames)};
}

Result<void> energy(const std::string& cache, const bench::BenchRun& run) {
    const double seconds = run.seconds(13);
    const ImageSize size = run.size({384, 216});
    const auto as_is = [](viewer::Preset&) {};
    const double bytes = static_cast<double>(std::filesystem::file_size(cache));
    const viewer::PipelineOptions caps{kCap, kCap, 2};
    LUCARNE_ASSIGN(const Flown capped, fly(cache, {.seconds = seconds, .size = size}, caps, as_is));
    figure("the cache over each of the caps of 128 MiB", bytes / static_cast<double>(kCap), "times");
    row("memory of the stream on the host", capped.most(&viewer::MemoryUse::host), "MiB", 128);
    row("memory of the device, all buffers", capped.most(&viewer::MemoryUse::device), "MiB", 128);
    const size_t frames = capped.frames.size(), half = frames / 2;
    figure("resident memory of the process (this device is software)",
           capped.most(&viewer::MemoryUse::resident), "MiB");
    row("the same, later half of the flight over the first",
        std::max(0.0, capped.most(&viewer::MemoryUse::resident, half, frames) -
                          capped.most(&viewer::MemoryUse::resident, 0, half)),
        "MiB", 16);
    const viewer::PipelineOptions all{uint64_t{4} << 30, uint64_t{16} << 30, 2};
    LUCARNE_ASSIGN(const Flown same, fly(cache, {.seconds = seconds, .size = size}, all, as_is));
    row("energy against the same budgets without caps", 100 * (capped.luminance() / same.luminance() - 1),
        "%", 3);
    // As fine as the device's buffers allow: the surfels that cast light and shadow are held in one buffer,
    // with 16 bytes a surfel.
    const auto fine = [](viewer::Preset& preset) {
        preset.budgets = {
            .view = 16'000'000, .light_view = 16'000'000, .light = 7'000'000, .pixel_spacing = 0.5};
    };
    LUCARNE_ASSIGN(const Flown whole,
                   fly(cache, {.frames_per_second = 0.5, .seconds = seconds, .size = size}, all, fine));
    double of_capped = 0;
    for (size_t i = 0; i < whole.frames.size() && 2 * i < frames; ++i)
        of_capped += *capped.frames[2 * i].luminance;
    row("energy against the whole cloud resident, cuts of 16M, 16M and 7M points",
        100 * (of_capped / static_cast<double>(whole.frames.size()) / whole.luminance() - 1), "%", 3);
    return {};
}

Result<void> flicker(const std::string& cache, const bench::BenchRun& run) {
    const viewer::PipelineOptions caps{kCap, kCap, 2};
    for (const bool wait : {true, false})
        for (const bool reuse : {false, true})
            for (const int32_t only : {-1, 1}) {
                const Way slowly{.frames_per_second = 12,
                                 .seconds = run.seconds(3),
                                 .wait = wait,
                                 .size = run.size({384, 216})};
                LUCARNE_ASSIGN(const Flown flown, fly(cache, slowly, caps, [&](viewer::Preset& preset) {
                                   preset.engine.set(gi::vpl::kReuse, reuse);
                                   preset.engine.set(gi::kOnlyBounce, only);
                               }));
                figure(fmt::format("flicker, {}, {}, {} ({} frames)",
                                   wait ? "every cut whole" : "nodes arriving",
                                   only < 0 ? "all light" : "bounce 1", reuse ? "reuse" : "no reuse",
                                   flown.frames.size()),
                       100 * flown.flicker(), "%");
            }
    return {};
}

Result<void> measure(const bench::BenchRun& run) {
    LUCARNE_ASSIGN(const std::string cache, cache_in(run));
    LUCARNE_TRY(energy(cache, run));
    return flicker(cache, run);
}

}  // namespace
}  // namespace lucarne

int main(int argc, char** argv) {
    return lucarne::bench::bench_main(argc, argv, lucarne::measure);
}
