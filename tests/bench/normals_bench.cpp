// Measures normals: PCL's estimator with its own search and with ours in turn, the whole stage, and the share
// of correctly oriented points of virtual scans. Prints figures beside their targets. `lucarne_normals
// [--scale S]`, of a million points a scan.
#include <algorithm>
#include <cstdio>
#include <ctime>
#include <numbers>

#include <fmt/format.h>

#include "tests/bench/bench_run.h"
#include "tests/bench/quantile.h"
#include "tests/octree/normals/pcl_normals.h"
#include "tests/octree/normals/virtual_scans.h"

namespace lucarne::octree {
namespace {

using namespace testing;
using bench::median;

double cpu_seconds() {
    timespec now{};
    clock_gettime(CLOCK_PROCESS_CPUTIME_ID, &now);
    return static_cast<double>(now.tv_sec) + 1e-9 * static_cast<double>(now.tv_nsec);
}

void row(const std::string& what, double value, const char* unit, const char* target, bool kept) {
    fmt::print("{:<64} {:>9.3f} {:<12} target {:>9}  {}\n", what, value, unit, target,
               kept ? "kept" : "MISSED");
    std::fflush(stdout);
}

/// Returns the share of normals that agree within a degree, up to their sign.
double agreeing(const std::vector<glm::vec3>& a, const std::vector<glm::vec3>& b) {
    const float degree = std::cos(std::numbers::pi_v<float> / 180);
    size_t same = 0;
    for (size_t i = 0; i < a.size(); ++i) same += std::abs(glm::dot(a[i], b[i])) >= degree;
    return static_cast<double>(same) / static_cast<double>(a.size());
}

/// Compares in the order of the scan, where the next point is nearly always in the processor's cache, or in
/// random order.
void compare_with_pcl(const Scan& scan, bool shuffled) {
    std::vector<glm::vec3> points;
    for (const auto& p : scan.cloud.points) points.emplace_back(p);
    lucarne::Random random(1);
    for (size_t i = points.size(); shuffled && i > 1; --i)
        std::swap(points[i - 1], points[static_cast<size_t>(random.uniform() * static_cast<double>(i))]);
    const char* order = shuffled ? "random order" : "scan order";
    const double millions = 1e-6 * static_cast<double>(points.size());
    std::vector<double> usual, ours, ratios;
    std::vector<glm::vec3> by_flann, by_leaf;
    for (int round = 0; round < 3; ++round) {
        const double start = cpu_seconds();
        by_flann = pcl_normals(points, 16, NeighbourSearch::flann);
        const double middle = cpu_seconds();
        by_leaf = pcl_normals(points, 16, NeighbourSearch::leaf);
        usual.push_back((middle - start) / millions);
        ours.push_back((cpu_seconds() - middle) / millions);
        ratios.push_back(usual.back() / ours.back());
    }
    row(fmt::format("pcl::NormalEstimationOMP, k = 16, its own search, {}", order), median(usual), "CPU-s/M",
        "-", true);
    row("the same, our search plugged in", median(ours), "CPU-s/M", "1.1", median(ours) <= 1.1);
    row("throughput over PCL's", median(ratios), "times", ">= 4", median(ratios) >= 4);
    const double same = agreeing(by_flann, by_leaf);
    row("normals within a degree of PCL's", 100 * same, "%", ">= 99", same >= 0.99);
}

void whole_stage(const std::string& scene, const Scan& scan) {
    NormalOptions options;
    options.stations = scan.stations;
    const double millions = 1e-6 * static_cast<double>(scan.cloud.points.size());
    std::vector<double> with, without;
    for (int round = 0; round < 3; ++round)
        for (const bool known : {true, false}) {
            options.stations = known ? scan.stations : std::vector<glm::dvec3>();
            const double start = cpu_seconds();
            estimate(scan.cloud, options, 2);
            (known ? with : without).push_back((cpu_seconds() - start) / millions);
        }
    row(scene + ": neighbours, normals, areas, orientation, stations known", median(with), "CPU-s/M", "1.0",
        median(with) <= 1.0);
    row(scene + ": the same, no stations", median(without), "CPU-s/M", "1.0", median(without) <= 1.0);
}

void orientation(const std::string& scene, const Scan& scan, double known, double unknown) {
    for (const bool stations : {true, false}) {
        NormalOptions options;
        if (stations) options.stations = scan.stations;
        const double target = stations ? known : unknown;
        double least = 1;
        for (const uint32_t parts : {1u, 3u})
            least = std::min(least, score(scan.cloud, estimate(scan.cloud, options, parts)).oriented);
        row(fmt::format("{}: oriented right, {}", scene, stations ? "stations known" : "no stations"),
            100 * least, "%", fmt::format(">= {}", 100 * target).c_str(), least >= target);
    }
}

Result<void> measure(const lucarne::bench::BenchRun& run) {
    const uint64_t points = run.points(1'000'000);
    fmt::print("{:.1f}M points a scan, as scanned from the scenes' stations, 2 mm noise\n",
               1e-6 * static_cast<double>(points));
    const Scan nave = scan_of("nave", points);
    compare_with_pcl(nave, false);
    compare_with_pcl(nave, true);
    whole_stage("nave", nave);
    orientation("nave", nave, 0.995, 0.97);
    orientation("two-rooms", scan_of("two-rooms", points), 0.995, 0.97);
    orientation("statue", scan_of("statue", points), 0.99, 0.99);
    return {};
}

}  // namespace
}  // namespace lucarne::octree

int main(int argc, char** argv) {
    return lucarne::bench::bench_main(argc, argv, lucarne::octree::measure);
}
