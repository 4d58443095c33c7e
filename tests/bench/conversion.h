#pragma once

#include <ctime>
#include <filesystem>
#include <fstream>
#include <memory>

#include <nlohmann/json.hpp>

#include "octree/cache/cache.h"
#include "tests/bench/bench_run.h"
#include "tests/bench/first_picture.h"
#include "tests/bench/rows.h"

namespace lucarne {

/// Returns the nanoseconds that one core takes to load a point (read, check, decode) with the file in the
/// page cache.
inline Result<double> decode_nanoseconds(const std::filesystem::path& cache) {
    LUCARNE_ASSIGN(const auto source, octree::open_cache(cache));
    double least = 0;
    for (int round = 0; round < 3; ++round) {  // the first round warms the page cache
        const std::clock_t start = std::clock();
        for (uint32_t node = 0; node < source->nodes().size(); ++node) LUCARNE_TRY(source->load(node));
        const double spent = 1e9 * static_cast<double>(std::clock() - start) / CLOCKS_PER_SEC /
                             static_cast<double>(source->header().points);
        least = round == 0 ? spent : std::min(least, spent);
    }
    return least;
}

struct ConversionTargets {
    const char* name;     ///< name of --normals' value in the table
    const char* normals;  ///< the value of --normals
    double cpu_seconds, bytes_a_point;
};

/// Converts the scan. Prints each stage's share, and the figures beside `targets`, which are for 20M points.
inline Result<void> bench_conversion_of(const std::filesystem::path& scan, double points,
                                        const ConversionTargets& targets) {
    const std::string cache = scan.string() + ".luc", report_file = scan.string() + ".json";
    LUCARNE_ASSIGN(const Usage used,
                   run_lucarne({"convert", scan.string(), "-o", cache, "--normals", targets.normals,
                                "--memory", "1G", "--overwrite", "--json", report_file}));
    std::ifstream in(report_file);
    const auto report = nlohmann::json::parse(in);
    fmt::print("  stages of the conversion {}:", targets.name);
    for (const auto& stage : report.at("stages"))
        fmt::print(" {} {:.0f} %", stage.at("name").get<std::string>(),
                   100 * stage.at("cpu_seconds").get<double>() / used.cpu_seconds);
    fmt::print("\n");
    const std::string what = fmt::format("{:.1f}M points {}, --memory 1G: ", 1e-6 * points, targets.name);
    row(what + "CPU", used.cpu_seconds, "s", targets.cpu_seconds * points / 20e6);
    row(what + "peak resident memory", used.peak_mebibytes, "MiB", 1024);
    row(what + "bytes a point", static_cast<double>(std::filesystem::file_size(cache)) / points, "bytes",
        targets.bytes_a_point);
    LUCARNE_ASSIGN(const double decode, decode_nanoseconds(cache));
    row(what + "loading a point", decode, "ns", 50);
    std::filesystem::remove(cache);
    std::filesystem::remove(report_file);
    return {};
}

/// Converts the survey without and with normals.
inline Result<void> bench_conversion(const bench::BenchRun& run) {
    const uint64_t points = run.points(20'000'000);
    const auto scan = run.folder / "survey.las";
    LUCARNE_TRY(run_lucarne(
        {"generate", "survey", "-o", scan.string(), "--points", std::to_string(points), "--overwrite"}));
    LUCARNE_TRY(bench_first_picture(scan));
    for (const auto& targets : {ConversionTargets{"without normals", "none", 6, 6.5},
                                ConversionTargets{"with normals", "estimate", 33, 8.5}})
        LUCARNE_TRY(bench_conversion_of(scan, static_cast<double>(points), targets));
    std::filesystem::remove(scan);
    return {};
}

}  // namespace lucarne
