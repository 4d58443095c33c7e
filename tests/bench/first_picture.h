#pragma once

#include <algorithm>
#include <chrono>
#include <filesystem>

#include "tests/bench/rows.h"

namespace lucarne {

/// Measures the time from the start of the process to the picture on disk for a scan without a cache: the
/// median of five runs, with the scan in the page cache. The scan has 520 MB: 20M points of 26 bytes.
inline Result<void> bench_first_picture(const std::filesystem::path& scan) {
    const std::string picture = scan.string() + ".png";
    const double megabytes = 1e-6 * static_cast<double>(std::filesystem::file_size(scan));
    for (const char* engine : {"direct", "vpl"}) {
        std::vector<double> seconds, cpu;
        for (int run = 0; run < 6; ++run) {
            const auto start = std::chrono::steady_clock::now();
            LUCARNE_ASSIGN(const Usage used, run_lucarne({"render", scan.string(), "--first", "--no-cache",
                                                          "--engine", engine, "-o", picture, "--overwrite"}));
            if (run == 0) continue;  // warms the caches of the scan and the shaders
            seconds.push_back(
                std::chrono::duration<double>(std::chrono::steady_clock::now() - start).count());
            cpu.push_back(used.cpu_seconds);
        }
        std::ranges::sort(seconds);
        std::ranges::sort(cpu);
        row(fmt::format("first picture of a LAS file of {:.0f} MB, {}", megabytes, engine),
            seconds[seconds.size() / 2], "s", 1.0);
        fmt::print("  of all cores: {:.2f} s\n", cpu[cpu.size() / 2]);
    }
    std::filesystem::remove(picture);
    return {};
}

}  // namespace lucarne
