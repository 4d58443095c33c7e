// Measures the time of the G-buffer for a nave seen from inside, with surfels at a constant spacing in the
// picture, as in a view cut. Prints the median of several runs, and the processor time of all cores, which
// depends less on other work on the machine. `bench_gbuffer [--scale S]`.
#include <algorithm>
#include <cstdio>
#include <ctime>
#include <functional>
#include <string>
#include <vector>

#include <fmt/format.h>

#include "gi/raster/blend.h"
#include "gi/raster/coverage.h"
#include "gi/raster/rims.h"
#include "io/core/random.h"
#include "tests/bench/bench_run.h"
#include "tests/gi/engines/surfel_cloud.h"

namespace lucarne::gi {
namespace {

struct Patch {  // a rectangle, or a cylinder's part around `u` where bend is set: radius |v|, angle in `turn`
    glm::vec3 corner, u, v, w;
    float turn;  // 0: flat
    glm::vec3 at(float a, float b) const {
        return turn == 0 ? corner + a * u + b * v
                         : corner + a * u + v * std::cos(turn * b) + w * std::sin(turn * b);
    }
    glm::vec3 normal(float b) const {
        return turn == 0 ? glm::normalize(glm::cross(u, v))
                         : glm::normalize(v * std::cos(turn * b) + w * std::sin(turn * b));
    }
    float area() const { return glm::length(u) * glm::length(v) * (turn == 0 ? 1.0f : std::abs(turn)); }
};

/// A nave along y, 12 m wide, 50 m long: floor, walls, barrel vault, two rows of columns, end wall, roof
/// above.
std::vector<Patch> nave() {
    const glm::vec3 y(0, 50, 0);
    std::vector<Patch> patches = {{{-6, 0, 0}, {12, 0, 0}, y, {}, 0},
                                  {{-6, 0, 0}, {0, 0, 8}, y, {}, 0},
                                  {{6, 0, 0}, {0, 0, 8}, y, {}, 0},
                                  {{-6, 50, 0}, {12, 0, 0}, {0, 0, 14}, {}, 0},
                                  {{0, 0, 8}, y, {6, 0, 0}, {0, 0, 6}, 3.14159f},
                                  {{-7, 0, 15}, {14, 0, 0}, y, {}, 0},
                                  {{-7, 0, 0}, {0, 0, 9}, y, {}, 0},
                                  {{7, 0, 0}, {0, 0, 9}, y, {}, 0}};
    for (float at = 4; at < 50; at += 4)
        for (const float x : {-3.5f, 3.5f})
            patches.push_back({{x, at, 0}, {0, 0, 9}, {0.45f, 0, 0}, {0, 0.45f, 0}, 6.28318f});
    return patches;
}

constexpr float kThinned = 16;  // a surfel's share of the surface in the cut, over that at full resolution

/// Returns about `wanted` surfels within the camera's view, hidden or not, with a density of 1/distance^2.
std::vector<Surfel> sample(const CameraView& view, size_t wanted) {
    const glm::vec3 eye(view.origin.x, view.origin.y, view.origin.z),
        f(view.forward.x, view.forward.y, view.forward.z);
    const glm::vec3 r(view.right.x, view.right.y, view.right.z), u(view.up.x, view.up.y, view.up.z);
    const auto seen = [&](const glm::vec3& p) {
        const float z = glm::dot(p - eye, f);
        return z > 0.3f && std::abs(glm::dot(p - eye, r)) < z * glm::dot(r, r) &&
               std::abs(glm::dot(p - eye, u)) < z * glm::dot(u, u);
    };
    const auto patches = nave();
    std::vector<Surfel> surfels;
    double total = 0;  // integral of dA / d^2 over the view
    for (const bool count_only : {true, false}) {
        Random random(7);
        const auto each = [&](const auto& take) {
            for (const Patch& patch : patches) {
                constexpr int kCells = 400;
                for (int i = 0; i < kCells * kCells; ++i) {
                    const float a = (static_cast<float>(i % kCells) + .5f) / kCells;
                    const float b = (static_cast<float>(i / kCells) + .5f) / kCells;
                    const glm::vec3 p = patch.at(a, b);
                    if (seen(p))
                        take(patch, a, b, patch.area() / (kCells * kCells), glm::dot(p - eye, p - eye));
                }
            }
        };
        if (count_only) {
            each([&](const Patch&, float, float, float area, float d2) { total += area / d2; });
            fmt::print("spacing: {:.2f} pixels\n",
                       std::sqrt(total / static_cast<double>(wanted)) * view.width / 2 / glm::length(r));
            continue;
        }
        each([&](const Patch& patch, float a, float b, float area, float d2) {
            const double expected = area / d2 / total * static_cast<double>(wanted);
            const auto n = static_cast<int>(expected + random.uniform());
            // Stratified within the cell, like an even level of detail.
            const int side = std::max(1, static_cast<int>(std::ceil(std::sqrt(n))));
            for (int k = 0; k < n; ++k) {
                const float ja = (static_cast<float>(k % side) + static_cast<float>(random.uniform())) /
                                 static_cast<float>(side);
                const float jb = (static_cast<float>(k / side) + static_cast<float>(random.uniform())) /
                                 static_cast<float>(side);
                const float sa = a + (ja - .5f) / 400, sb = b + (jb - .5f) / 400;
                Surfel s{};
                s.position = patch.at(sa, sb);
                s.normal = patch.normal(sb);
                s.albedo = glm::vec3(0.5f);
                s.area = static_cast<float>(d2 * total / static_cast<double>(wanted)) / kThinned;
                surfels.push_back(s);
            }
        });
    }
    return surfels;
}

double now(clockid_t clock) {
    timespec t{};
    clock_gettime(clock, &t);
    return static_cast<double>(t.tv_sec) + 1e-9 * static_cast<double>(t.tv_nsec);
}

/// Times a pass in turns with the others, so that other work on the machine slows down all of them alike.
struct Pass {
    std::string name;
    std::function<Result<void>()> run;
    std::vector<double> wall, cpu;  // s
};

Result<void> time_passes(Device& device, std::vector<Pass>& passes, int frames) {
    for (int i = 0; i < frames; ++i)
        for (Pass& pass : passes) {
            device.finish();
            const double wall_start = now(CLOCK_MONOTONIC), cpu_start = now(CLOCK_PROCESS_CPUTIME_ID);
            LUCARNE_TRY(pass.run());
            device.finish();
            pass.wall.push_back(now(CLOCK_MONOTONIC) - wall_start);
            pass.cpu.push_back(now(CLOCK_PROCESS_CPUTIME_ID) - cpu_start);
        }
    for (Pass& pass : passes) {
        std::sort(pass.wall.begin(), pass.wall.end());
        std::sort(pass.cpu.begin(), pass.cpu.end());
        fmt::print("  {:<20} median {:.1f} ms, best {:.1f} ms; processor time {:.1f} ms\n", pass.name,
                   pass.wall[pass.wall.size() / 2] * 1e3, pass.wall[0] * 1e3,
                   pass.cpu[pass.cpu.size() / 2] * 1e3);
    }
    return {};
}

Result<void> measure_at(const bench::BenchRun& run, uint64_t points, ImageSize full) {
    const auto [width, height] = run.size(full);
    LUCARNE_ASSIGN(const auto device, Device::headless());
    const CameraView view = look({0.3f, 1, 3}, {0, 50, 5}, width, height, 1.0f);
    std::vector<Surfel> surfels = sample(view, run.points(points));
    const SurfelCloud cloud(std::move(surfels), {{-16, -1, -1}, 64}, 1024, kThinned);
    LUCARNE_ASSIGN(const auto packed, load_cloud(*device, cloud));
    GBuffer gbuffer;
    const bool software = device->native_passes();
    std::vector<Pass> passes;
    for (const bool native : {false, true}) {
        if (native && !software) continue;
        const std::string how = native ? ", native" : ", shaders";
        passes.push_back({"visibility" + how,
                          [&, native] {
                              device->use_native_passes(native);
                              return rasterize(*device, packed->cut, view, gbuffer);
                          },
                          {},
                          {}});
        passes.push_back(
            {"blending" + how, [&] { return blend(*device, packed->cut, view, gbuffer); }, {}, {}});
        passes.push_back({"rims" + how, [&] { return turn_rims(*device, view, gbuffer); }, {}, {}});
        passes.push_back(
            {"coverage" + how, [&] { return find_coverage(*device, packed->cut, view, gbuffer); }, {}, {}});
    }
    LUCARNE_TRY(passes[0].run());
    const auto ids = gbuffer.ids.download_all<uint32_t>(size_t{width} * height);
    const auto empty = std::count(ids.begin(), ids.end(), kNoSurfel);
    fmt::print("{} surfels in {} nodes, {}x{}: {} pixels empty\n", packed->cut.surfels(),
               cloud.nodes().size(), width, height, empty);
    return time_passes(*device, passes, run.frames(9));
}

Result<void> measure(const bench::BenchRun& run) {
    LUCARNE_TRY(measure_at(run, 5'000'000, {1280, 720}));
    return measure_at(run, 1'000'000, {512, 512});
}

}  // namespace
}  // namespace lucarne::gi

int main(int argc, char** argv) {
    return lucarne::bench::bench_main(argc, argv, lucarne::gi::measure);
}
