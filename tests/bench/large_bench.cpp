// Builds clouds larger than any memory with --memory 1G. Their points are computed while they are read, so
// only the cache and its scratch file need disk space. `lucarne_large [FOLDER] [--scale S]`: a scale of 0.1
// makes everything a tenth as large. At 1 it takes some 40 GB of disk in FOLDER (default: a temporary one)
// and an hour.
#include <cmath>
#include <cstdio>
#include <filesystem>
#include <functional>

#include <fmt/format.h>
#include <sys/resource.h>
#include <sys/wait.h>
#include <unistd.h>

#include "io/core/progress.h"
#include "io/core/random.h"
#include "octree/cache/cache.h"
#include "octree/convert/build.h"
#include "tests/bench/bench_run.h"
#include "tests/octree/test_sources.h"

namespace lucarne {
namespace {

constexpr uint64_t kMemory = uint64_t{1} << 30;

using Place = std::function<glm::dvec3(uint64_t index)>;

/// Returns a scan with records like a LAS file's: millimetres, colour, intensity; 20 bytes.
test::ComputedSource scan_of(uint64_t points, double metres_per_step, const Place& place) {
    io::Schema schema;
    schema.position = io::PositionType::i32_scaled;
    schema.scale = glm::dvec3(metres_per_step);
    schema.stride = 12;
    schema.add("color", io::ScalarType::u16, 3);
    schema.add("intensity", io::ScalarType::u16);
    return {schema, points, [place, metres_per_step](uint64_t index, std::byte* record) {
                const glm::dvec3 p = place(index);
                for (int axis = 0; axis < 3; ++axis)
                    io::store(record + 4 * axis,
                              static_cast<int32_t>(std::lround(p[axis] / metres_per_step)));
                io::store(record + 12, index * 0x9e3779b97f4a7c15ull);
            }};
}

/// Returns a point in streets of houses with floors and walls, scanned house by house.
glm::dvec3 in_a_town(uint64_t index, uint64_t points) {
    constexpr uint64_t kHouses = 1000, kARow = 32;
    Random random(3, index);
    const uint64_t house = index * kHouses / points;
    const double u = 10 * random.uniform(), v = 10 * random.uniform(), rough = .005 * random.uniform();
    glm::dvec3 p(u, v, rough);
    if (index % 3 == 1) p = {u, rough, .8 * v};
    if (index % 3 == 2) p = {rough, u, .8 * v};
    return p + 14.0 * glm::dvec3(static_cast<double>(house % kARow), static_cast<double>(house / kARow), 0);
}

glm::dvec3 on_a_statue(uint64_t index) {
    Random random(9, index);
    const double z = 2 * random.uniform() - 1, angle = 2 * M_PI * random.uniform(), r = std::sqrt(1 - z * z);
    return {r * std::cos(angle), r * std::sin(angle), z};
}

struct Cloud {
    const char* name;
    uint64_t points;
    double metres_per_step;
    octree::NormalsMode normals;
    std::function<glm::dvec3(uint64_t index, uint64_t points)> place;
};

std::vector<Cloud> clouds() {
    const auto none = octree::NormalsMode::none, estimate = octree::NormalsMode::estimate;
    return {
        {"a town of 500M points", 500'000'000, 1e-3, none, in_a_town},
        {"a billion times one point", 1'000'000'000, 1e-3, none,
         [](uint64_t, uint64_t) { return glm::dvec3(3, 4, 5); }},
        {"10M points in one plane", 10'000'000, 1e-3, estimate,
         [](uint64_t i, uint64_t) {
             Random random(2, i);
             return glm::dvec3(50 * random.uniform(), 30 * random.uniform(), 7);
         }},
        {"10M points of a statue in 100 km", 10'000'000, 1e-4, estimate,
         [](uint64_t i, uint64_t) { return i < 2 ? glm::dvec3(i ? 5e4 : -5e4) : on_a_statue(i); }},
        {"10M points in a millimetre", 10'000'000, 1e-9, none,
         [](uint64_t i, uint64_t) {
             Random random(3, i);
             return 1e-3 * glm::dvec3(random.uniform(), random.uniform(), random.uniform());
         }},
    };
}

/// Builds one cloud in this process and prints its row. Returns whether that succeeded.
bool build(const Cloud& cloud, uint64_t points, const std::filesystem::path& folder) {
    const auto source =
        scan_of(points, cloud.metres_per_step, [&](uint64_t index) { return cloud.place(index, points); });
    octree::BuildOptions options;
    options.inputs = {&source};
    options.output = folder / "large.luc";
    options.normals = cloud.normals;
    options.memory = kMemory;
    options.overwrite = true;
    const auto report = octree::build_cache(options);
    if (!report) {
        fmt::print("{}: {}\n", cloud.name, report.error().line());
        return false;
    }
    rusage used{};
    getrusage(RUSAGE_SELF, &used);
    const auto cache = octree::open_cache(options.output);
    uint32_t most = 0;
    if (cache)
        for (const auto& node : (*cache)->nodes()) most = std::max(most, node.count);
    double cpu = 0, wall = 0;
    for (const auto& stage : report->stages) cpu += stage.cpu_seconds, wall += stage.wall_seconds;
    const double peak = static_cast<double>(used.ru_maxrss) / 1024;
    fmt::print(
        "{:<36} {:>7.1f}M points, {:>8} nodes of {:>6} points at most, {:>5.2f} bytes a point, {:>6.0f} "
        "CPU-s, "
        "{:>6.0f} s; peak {:>5.0f} MiB, target 1024  {}\n",
        cloud.name, 1e-6 * static_cast<double>(report->points), report->nodes, most,
        static_cast<double>(std::filesystem::file_size(options.output)) / static_cast<double>(report->points),
        cpu, wall, peak, peak <= 1024 && cache ? "kept" : "MISSED");
    std::fflush(stdout);
    std::filesystem::remove(options.output);
    return cache.has_value();
}

Result<void> measure(const bench::BenchRun& run) {
    Progress::set_silent(true);
    std::string failures;
    for (const Cloud& cloud : clouds()) {
        // Each cloud has its own process, so that the resident memory of the last one does not count.
        const uint64_t points = run.points(cloud.points);
        const pid_t child = fork();
        if (child == 0) _exit(build(cloud, points, run.folder) ? 0 : 1);
        int status = 1;
        if (child < 0 || waitpid(child, &status, 0) < 0 || status != 0)
            failures += failures.empty() ? cloud.name : std::string(", ") + cloud.name;
    }
    if (!failures.empty()) return failed(failures, "could not be built");
    return {};
}

}  // namespace
}  // namespace lucarne

int main(int argc, char** argv) {
    return lucarne::bench::bench_main(argc, argv, lucarne::measure);
}
