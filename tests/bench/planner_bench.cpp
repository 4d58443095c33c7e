// Plans the conversion of a synthetic catalogue: `lucarne_planner [--scale S]`, 100 000 tiles and 10^12
// points at scale 1. Prints time, memory and numbers of chunks beside their targets.
#include <chrono>
#include <cstdlib>
#include <fstream>
#include <string>

#include "tests/bench/machine.h"
#include "tests/octree/convert/catalogue.h"

namespace {

/// Returns the most memory that the process has had resident, MiB.
double peak_mib() {
    std::ifstream status("/proc/self/status");
    for (std::string line; std::getline(status, line);)
        if (line.starts_with("VmHWM:")) return std::atof(line.c_str() + 6) / 1024;
    return 0;
}

}  // namespace

int main(int argc, char** argv) {
    using Clock = std::chrono::steady_clock;
    fmt::print("{}\n", lucarne::bench::circumstances());
    double scale = 1;
    for (int i = 1; i + 1 < argc; ++i)
        if (std::string(argv[i]) == "--scale") scale = std::atof(argv[i + 1]);
    const auto tiles = static_cast<size_t>(100'000 * scale);
    const auto start = Clock::now();
    const lucarne::test::Catalogue catalogue(tiles, 10'000'000);
    const double headers = peak_mib();
    const auto planned = lucarne::test::plan(catalogue, 256, uint64_t{2} << 30);
    const double seconds = std::chrono::duration<double>(Clock::now() - start).count();
    if (!planned) {
        fmt::print(stderr, "{}\n", planned.error().line());
        return 1;
    }
    fmt::print("{} tiles, {:.1e} points, 256 ranks, --memory 2G\n", tiles, double(catalogue.points));
    fmt::print("  time                 {:8.1f} s      (target: 60)\n", seconds);
    fmt::print("  peak memory          {:8.0f} MiB    (target: 1024; headers {:.0f})\n", peak_mib(), headers);
    fmt::print("  chunks               {:8} of the grid, {} after splitting\n", planned->coarse_chunks,
               planned->chunks);
    fmt::print("  fullest rank         {:8.3f} of the mean\n",
               double(planned->most_points_of_rank) * 256 / double(catalogue.points));
    fmt::print("  metadata             {:8.1f} MiB\n", double(planned->metadata_bytes) / (1 << 20));
    return 0;
}
