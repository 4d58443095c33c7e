// Measures streaming with `lucarne fly` and prints the figures beside their targets: time of loading in a
// frame, cold starts, the gain of loading ahead, popping, memory over a long flight, many caches.
// `lucarne_stream [FOLDER] [--scale S] [--soak SECONDS]`: FOLDER holds the caches (default: a temporary
// folder, 1 GB); SECONDS is the duration of the long flight (default 60; an hour is 3600).
#include <filesystem>
#include <fstream>
#include <string>
#include <vector>

#include <fmt/format.h>
#include <nlohmann/json.hpp>

#include "tests/bench/bench_run.h"
#include "tests/bench/rows.h"

namespace lucarne {
namespace {

using nlohmann::json;

/// The scan to fly through and its files.
struct Ground {
    const bench::BenchRun& run;

    /// The path to fly; in a trial half a second of it.
    std::string path() const {
        if (!run.trial()) return LUCARNE_SOURCE_DIR "/data/flythroughs/nave.json";
        return write("path.json", R"({"frames_per_second": 25, "keys": [
            {"time": 0, "position": [0, 3.2, 1.8], "target": [0, 15, 5], "fov": 65},
            {"time": 0.5, "position": [0.2, 4.2, 1.9], "target": [-0.2, 16, 5.1], "fov": 65}]})");
    }
    std::string size() const {
        const ImageSize size = run.size({384, 216});
        return fmt::format("{}x{}", size.width, size.height);
    }
    std::string write(const std::string& name, const std::string& text) const {
        std::ofstream(file(name)) << text;
        return file(name);
    }
    std::string cache() const { return file(fmt::format("nave-{}.luc", points())); }
    std::string file(const std::string& name) const { return run.folder / name; }
    uint64_t points() const { return run.points(4'000'000); }
};

constexpr const char* kScene = LUCARNE_SOURCE_DIR "/data/scenes/nave.json";

Result<void> make_cache(const Ground& ground) {
    const std::string scan = ground.file("nave.ply");
    LUCARNE_TRY(run_lucarne({"generate", "nave", "-o", scan, "--points", std::to_string(ground.points()),
                             "--even", "--normals", "--overwrite"}));
    LUCARNE_TRY(run_lucarne({"convert", scan, "-o", ground.cache(), "--normals", "keep", "--overwrite"}));
    std::filesystem::remove(scan);
    return {};
}

/// Flies and returns the report.
Result<json> fly(const Ground& ground, std::vector<std::string> arguments) {
    const std::string report = ground.file("report.json");
    for (const std::string& also :
         {std::string("--path"), ground.path(), std::string("--scene"), std::string(kScene),
          std::string("--engine"), std::string("direct"), std::string("--size"), ground.size(),
          std::string("--overwrite"), std::string("-o"), report})
        arguments.push_back(also);
    arguments.insert(arguments.begin(), "fly");
    LUCARNE_TRY(run_lucarne(arguments));
    std::ifstream file(report);
    return json::parse(file);
}

Result<void> bench_cold_start(const Ground& ground) {
    LUCARNE_ASSIGN(const json both, fly(ground, {ground.cache(), "--realtime", "--cold"}));
    for (const json& flight : both["flights"]) {
        const std::string start = flight["start"]["cold"] ? "cold" : "warm";
        const json& complete = flight["start"]["complete_cut_seconds"];
        if (!complete.is_null())
            figure(start + " start to the first complete cut, by the clock", complete.get<double>(), "s");
        figure(start + ": cuts complete, mean over the flight",
               100 * flight["complete"]["mean"].get<double>(), "%");
        row(start + ": loading in a frame, p99", flight["loading_ms"]["p99"].get<double>(), "ms", 5);
    }
    return {};
}

Result<void> bench_prefetch(const Ground& ground) {
    std::vector<double> missing;
    for (const bool ahead : {false, true}) {
        std::vector<std::string> arguments = {ground.cache(), "--realtime", "--cold", "--device-memory",
                                              "96M"};
        if (!ahead) arguments.emplace_back("--no-prefetch");
        LUCARNE_ASSIGN(const json both, fly(ground, arguments));
        missing.push_back(100 * (1 - both["flights"][0]["complete"]["mean"].get<double>()));
    }
    figure("points missing in their frame, cold, nothing loaded ahead", missing[0], "%");
    row("the same, loading ahead", missing[1], "%", missing[0]);
    return {};
}

Result<void> bench_popping(const Ground& ground) {
    // A slow path: every picture is nearly the one before.
    const std::string slow = ground.write("slow.json", fmt::format(R"({{"frames_per_second": 25, "keys": [
        {{"time": 0, "position": [0, 3.2, 1.8], "target": [0, 15, 5], "fov": 65}},
        {{"time": {}, "position": [0.1, 3.8, 1.85], "target": [-0.1, 15.5, 5.1], "fov": 65}}]}})",
                                                                   ground.run.trial() ? .2 : 2));
    const std::string report = ground.file("report.json");
    LUCARNE_TRY(
        run_lucarne({"fly", ground.cache(), "--popping", "--path", slow, "--scene", kScene, "--engine",
                     "direct", "--size", ground.size(), "--points", "400000", "--overwrite", "-o", report}));
    std::ifstream file(report);
    const json flight = json::parse(file);
    row("largest change between pictures over that of the whole cloud",
        flight["popping"]["ratio"].get<double>(), "times", 1.5);
    row("the same, of the worst tile of 16 x 16 pixels", flight["popping"]["tile_ratio"].get<double>(),
        "times", 1.5);
    return {};
}

Result<void> bench_soak(const Ground& ground) {
    const std::string seconds = fmt::format("{}", ground.run.option("soak", ground.run.seconds(60)));
    LUCARNE_ASSIGN(const json flight, fly(ground, {ground.cache(), "--realtime", "--soak", seconds,
                                                   "--memory", "64M", "--device-memory", "64M"}));
    const json& soak = flight["soak"];
    figure(fmt::format("flight of {} s: laps", seconds), soak["laps"].get<double>(), "");
    row("the same: resident memory, last lap over the first",
        std::max(0.0, soak["resident_memory"]["growth"].get<double>() / 1048576), "MiB", 8);
    row("the same: most of the cap of memory", flight["memory"]["used"].get<double>() / 1048576, "MiB", 64);
    row("the same: most of the cap of device memory", flight["device_memory"]["used"].get<double>() / 1048576,
        "MiB", 64);
    return {};
}

/// Moves a LAS file by changing its header's offsets and bounds (LAS 1.4 R15, table 3).
void move_las(const std::string& file, double x, double y) {
    std::fstream las(file, std::ios::in | std::ios::out | std::ios::binary);
    const auto add = [&](std::streamoff at, double by) {
        double value = 0;
        las.seekg(at).read(reinterpret_cast<char*>(&value), sizeof value);
        value += by;
        las.seekp(at).write(reinterpret_cast<const char*>(&value), sizeof value);
    };
    for (const std::streamoff at : {155, 179, 187}) add(at, x);
    for (const std::streamoff at : {163, 195, 203}) add(at, y);
}

/// Flies through the first of many caches that lie side by side like the scans of a town.
Result<void> bench_many_caches(const Ground& ground) {
    const std::string scan = ground.file("small.las");
    const uint64_t caches = ground.run.count(200);
    LUCARNE_TRY(run_lucarne({"generate", "nave", "-o", scan, "--points", "50k", "--overwrite"}));
    std::vector<std::string> arguments;
    for (uint64_t i = 0; i < caches; ++i) {
        const std::string moved = ground.file("moved.las");
        std::filesystem::copy_file(scan, moved, std::filesystem::copy_options::overwrite_existing);
        move_las(moved, 15.0 * static_cast<double>(i % 20), 40.0 * static_cast<double>(i / 20));
        arguments.push_back(ground.file(fmt::format("small{}.luc", i)));
        LUCARNE_TRY(run_lucarne({"convert", moved, "-o", arguments.back(), "--overwrite"}));
    }
    for (const char* also : {"--realtime", "--points", "1000000"}) arguments.emplace_back(also);
    LUCARNE_ASSIGN(const json flight, fly(ground, arguments));
    row(fmt::format("{} caches in one scene: points of the view cut", caches),
        flight["points_per_frame"]["view"]["max"].get<double>() / 1e6, "M", 1);
    figure("the same: opened after", flight["start"]["open_seconds"].get<double>(), "s");
    row("the same: loading in a frame, p99", flight["loading_ms"]["p99"].get<double>(), "ms", 5);
    figure("the same: a frame, median", flight["frame_ms"]["p50"].get<double>(), "ms");
    for (const std::string& argument : arguments)
        if (argument.ends_with(".luc")) std::filesystem::remove(argument);
    return {};
}

Result<void> measure(const bench::BenchRun& run) {
    const Ground ground{run};
    if (!std::filesystem::exists(ground.cache())) LUCARNE_TRY(make_cache(ground));
    LUCARNE_TRY(bench_cold_start(ground));
    LUCARNE_TRY(bench_prefetch(ground));
    LUCARNE_TRY(bench_popping(ground));
    LUCARNE_TRY(bench_many_caches(ground));
    return bench_soak(ground);
}

}  // namespace
}  // namespace lucarne

int main(int argc, char** argv) {
    return lucarne::bench::bench_main(argc, argv, lucarne::measure, {.options = {"soak"}});
}
