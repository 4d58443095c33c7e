#include "gi/gather/gatherer.h"

#include <algorithm>
#include <cmath>

#include <fmt/format.h>

#include "gi/shared/brdf.h"
#include "io/core/parallel.h"
#include "io/core/random.h"

namespace lucarne::gi {
namespace {

constexpr const char* kSource = "gi/gather/gather.cl";
constexpr uint32_t kSets = 32;  // of rays; points choose among them
constexpr float kNoRay = 2;     // as x
constexpr size_t kPointsATask = 64;
constexpr double kRim = 1 - 1e-6;  // rays in the plane of the surface would meet it
/// Points of one run of the kernel, short enough for displays' watchdogs and to be stopped in between, and
/// work-items of a group.
struct Launch {
    size_t points, group;
};
constexpr Launch kOnProcessor{4096, 1}, kOnGpu{65536, 32};

/// A disc in a square holds pi / 4 of its pixels.
uint32_t grid_for(uint32_t side) {
    return static_cast<uint32_t>(std::lround(side * std::sqrt(4 / M_PI)));
}

/// Rows have seven floats of room behind their last pixel and are multiples of eight.
uint32_t row_for(uint32_t grid) {
    return (grid + 14) / 8 * 8;
}

Defines defines_for(uint32_t grid, Fill fill = Fill::rays) {
    return {{"LUCARNE_GRID", fmt::format("{}", grid)},
            {"LUCARNE_ROW", fmt::format("{}", row_for(grid))},
            {"LUCARNE_FILL_PIXELS", fill == Fill::pixels ? "1" : "0"}};
}

}  // namespace

Result<std::vector<uint32_t>> MicroBuffers::seen() const {
    std::vector<uint32_t> result(count_ * grid_ * grid_);
    if (count_ > 0) LUCARNE_TRY(seen_.download(0, std::as_writable_bytes(std::span(result))));
    return result;
}

Result<std::vector<float>> MicroBuffers::nearness() const {
    std::vector<float> result(count_);
    if (count_ > 0) LUCARNE_TRY(nearness_.download(0, std::as_writable_bytes(std::span(result))));
    return result;
}

Result<void> Gatherer::set_tree(ClDevice& device, const std::shared_ptr<const SurfelTree>& tree) {
    ++tree_;
    set_no_bright();
    openings_ = nullptr;
    empty_ = !tree || tree->empty();
    if (!empty_) return device.lend(nodes_, std::as_bytes(std::span(tree->nodes)), tree, "tree of surfels");
    const auto nothing = std::make_shared<const WideNode>(empty_node());
    return device.lend(nodes_, std::as_bytes(std::span(nothing.get(), 1)), nothing, "tree of surfels");
}

Result<void> Gatherer::set_light(ClDevice& device, std::span<const SideLight> slots) {
    set_no_bright();
    if (slots.empty()) return {};
    const auto bytes = std::as_bytes(slots);
    LUCARNE_TRY(device.reserve(light_, bytes.size(), "light of the tree"));
    return light_.upload(0, bytes);
}

Result<void> Gatherer::set_bright(ClDevice& device, std::span<const SideLight> slots, float reach2) {
    const auto bytes = std::as_bytes(slots);
    LUCARNE_TRY(device.reserve(bright_, bytes.size(), "bright light of the tree"));
    LUCARNE_TRY(bright_.upload(0, bytes));
    reach2_ = reach2;
    return {};
}

Result<void> Gatherer::set_openings(ClDevice& device, const SkyOpenings* openings, uint32_t rays) {
    openings_ = nullptr;
    if (!openings || openings->empty()) return {};
    const auto bytes = std::as_bytes(openings->spheres());
    LUCARNE_TRY(device.reserve(spheres_, bytes.size(), "openings to the sky"));
    LUCARNE_TRY(spheres_.upload(0, bytes));
    openings_ = openings;
    rays_to_sky_ = rays;
    return {};
}

Result<void> Gatherer::send_densities(ClDevice& device, std::span<const GatherPoint> points, uint32_t grid) {
    const size_t spheres = openings_->spheres().size();
    densities_.resize(points.size() * spheres);
    rays_over_buffer_ = static_cast<float>(rays_to_sky_) / (static_cast<float>(grid * grid) * kPi / 4);
    parallel_ranges(points.size(), kPointsATask, [&](size_t first, size_t last) {
        for (size_t i = first; i < last; ++i)
            openings_->find_densities(points[i], rays_over_buffer_,
                                      std::span(densities_).subspan(i * spheres, spheres));
    });
    const auto bytes = std::as_bytes(std::span(densities_));
    LUCARNE_TRY(device.reserve(densities_of_, bytes.size(), "rays to openings"));
    return densities_of_.upload(0, bytes);
}

void Gatherer::each_sky_ray(
    std::span<const GatherPoint> points,
    const std::function<void(size_t, const glm::vec3&, const glm::vec3&)>& visit) const {
    const size_t spheres = openings_->spheres().size();
    parallel_ranges(points.size(), kPointsATask, [&](size_t first, size_t last) {
        for (size_t i = first; i < last; ++i)
            openings_->each_ray(
                points[i], std::span(densities_).subspan(i * spheres, spheres), rays_over_buffer_,
                rays_to_sky_,
                [&](const glm::vec3& direction, const glm::vec3& light) { visit(i, direction, light); });
    });
}

Result<void> Gatherer::set_lobes(ClDevice& device, const SideLobes& lobes) {
    glossy_ = false;
    if (lobes.light.empty()) return {};
    const auto light = std::as_bytes(std::span(lobes.light));
    const auto directions = std::as_bytes(std::span(lobes.directions));
    LUCARNE_TRY(device.reserve(lobe_light_, light.size(), "lobes of the tree"));
    LUCARNE_TRY(device.reserve(lobe_directions_, directions.size(), "directions of lobes"));
    LUCARNE_TRY(lobe_light_.upload(0, light));
    LUCARNE_TRY(lobe_directions_.upload(0, directions));
    glossy_ = true;
    return {};
}

Result<void> Gatherer::set_sky(ClDevice& device, const GatherSky& sky) {
    sky_ = {sky.width, sky.height, sky.rotation, 0};
    if (sky.texels.empty()) return {};
    const auto bytes = std::as_bytes(std::span(sky.texels));
    LUCARNE_TRY(device.reserve(sky_texels_, bytes.size(), "sky"));
    return sky_texels_.upload(0, bytes);
}

/// Makes kSets sets of rays: one in every pixel of the unit disc, at a random place of the pixel.
Result<void> Gatherer::make_rays(ClDevice& device, uint32_t grid, uint64_t seed) {
    if (rays_ && grid_ == grid && seed_ == seed) return {};
    const size_t row = row_for(grid), pixels = grid * row;
    std::vector<float> rays(kSets * 2 * pixels, kNoRay);
    Random random(seed, grid);
    for (size_t set = 0; set < kSets; ++set)
        for (size_t j = 0; j < grid; ++j)
            for (size_t i = 0; i < grid; ++i) {
                const double x = 2 * (static_cast<double>(i) + random.uniform()) / grid - 1;
                const double y = 2 * (static_cast<double>(j) + random.uniform()) / grid - 1;
                if (x * x + y * y >= kRim) continue;
                float* ray = &rays[set * 2 * pixels + j * row + i];
                ray[0] = static_cast<float>(x);
                ray[pixels] = static_cast<float>(y);
            }
    LUCARNE_TRY(device.reserve(rays_, rays.size() * sizeof(float), "rays"));
    LUCARNE_TRY(rays_.upload(0, std::as_bytes(std::span(rays))));
    grid_ = grid;
    seed_ = seed;
    return {};
}

Result<void> Gatherer::gather(ClDevice& device, Gathered what, std::span<const GatherPoint> points,
                              uint32_t side, uint64_t seed, std::span<glm::vec4> results,
                              const std::atomic<bool>* stop, const std::function<void(size_t)>& done,
                              Fill fill) {
    const auto [lit, glossy, sky, open] = asked(what);
    const uint32_t grid = grid_for(side);
    LUCARNE_TRY(make_rays(device, grid, seed));
    LUCARNE_ASSIGN(const ClKernel* kernel, device.kernel(kSource, "gather", defines_for(grid, fill)));
    const Launch launch = device.info().is_gpu ? kOnGpu : kOnProcessor;
    const size_t most = std::min(points.size(), launch.points);
    LUCARNE_TRY(device.reserve(points_, most * sizeof(GatherPoint), "gather points"));
    LUCARNE_TRY(device.reserve(results_, most * sizeof(glm::vec4), "gathered light"));
    for (size_t first = 0; first < points.size(); first += launch.points) {
        if (stop && *stop) return {};
        const size_t count = std::min(launch.points, points.size() - first);
        const auto some = points.subspan(first, count);
        if (open > 0) LUCARNE_TRY(send_densities(device, some, grid));
        LUCARNE_TRY(points_.upload(0, std::as_bytes(some)));
        LUCARNE_TRY(kernel->run(ClRange(count, launch.group), nodes_, lit ? light_ : nodes_, lit,
                                glossy ? lobe_light_ : nodes_, glossy ? lobe_directions_ : nodes_, glossy,
                                reach2_ >= 0 ? bright_ : nodes_, reach2_,
                                sky.width > 0 ? sky_texels_ : nodes_, sky, open > 0 ? spheres_ : nodes_, open,
                                open > 0 ? densities_of_ : nodes_, points_, rays_, kSets,
                                static_cast<uint32_t>(count), results_));
        LUCARNE_TRY(results_.download(0, std::as_writable_bytes(results.subspan(first, count))));
        if (open > 0)
            each_sky_ray(some, [&](size_t i, const glm::vec3&, const glm::vec3& light) {
                results[first + i] += glm::vec4(light, 0);
            });
        if (done) done(first + count);
    }
    return {};
}

Gatherer::Asked Gatherer::asked(Gathered what) const {
    const bool lit = what != Gathered::sky && !empty_;
    const bool sky = what != Gathered::light_of_surfels;
    return {lit, lit && glossy_, sky ? sky_ : SkyPicture{},
            sky && openings_ ? static_cast<uint32_t>(openings_->spheres().size()) : 0};
}

Result<void> Gatherer::see(ClDevice& device, std::span<const GatherPoint> points, uint32_t side,
                           uint64_t seed, MicroBuffers& buffers, const std::atomic<bool>* stop) {
    const uint32_t grid = grid_for(side);
    const auto bytes = std::as_bytes(points);
    if (buffers.count_ == points.size() && buffers.grid_ == grid && buffers.seed_ == seed &&
        buffers.tree_ == tree_ && std::ranges::equal(std::as_bytes(std::span(buffers.held_)), bytes))
        return {};
    buffers.count_ = 0;
    buffers.held_.assign(points.begin(), points.end());
    if (points.empty()) return {};
    LUCARNE_TRY(make_rays(device, grid, seed));
    LUCARNE_ASSIGN(const ClKernel* kernel, device.kernel(kSource, "see", defines_for(grid)));
    const size_t count = points.size(), pixels = size_t{grid} * grid;
    LUCARNE_TRY(device.reserve(buffers.points_, count * sizeof(GatherPoint), "gather points"));
    LUCARNE_TRY(device.reserve(buffers.seen_, count * pixels * sizeof(uint32_t), "micro-buffers"));
    LUCARNE_TRY(device.reserve(buffers.nearness_, count * sizeof(float), "distances"));
    LUCARNE_TRY(buffers.points_.upload(0, bytes));
    const Launch launch = device.info().is_gpu ? kOnGpu : kOnProcessor;
    for (size_t first = 0; first < count; first += launch.points) {
        if (stop && *stop) return {};
        const size_t some = std::min(launch.points, count - first);
        LUCARNE_TRY(kernel->run(ClRange(some, launch.group), nodes_, buffers.points_, rays_, kSets,
                                static_cast<uint32_t>(first), static_cast<uint32_t>(some), buffers.seen_,
                                buffers.nearness_));
        if (stop) LUCARNE_TRY(device.finish());
    }
    buffers.count_ = count;
    buffers.grid_ = grid;
    buffers.seed_ = seed;
    buffers.tree_ = tree_;
    return {};
}

Result<std::vector<LightByNormal>> Gatherer::shade(ClDevice& device, Gathered what,
                                                   const MicroBuffers& buffers,
                                                   const std::atomic<bool>* stop) {
    std::vector<LightByNormal> result(buffers.count());
    if (result.empty()) return result;
    const auto [lit, glossy, sky, open] = asked(what);
    LUCARNE_TRY(make_rays(device, buffers.grid_, buffers.seed_));
    LUCARNE_ASSIGN(const ClKernel* kernel, device.kernel(kSource, "shade", defines_for(buffers.grid_)));
    LUCARNE_TRY(device.reserve(results_, result.size() * sizeof(LightByNormal), "gathered light"));
    const Launch launch = device.info().is_gpu ? kOnGpu : kOnProcessor;
    const std::span<const GatherPoint> points = buffers.held_;
    std::vector<LightByNormal> by_rays(open > 0 ? points.size() : 0);
    for (size_t first = 0; first < result.size(); first += launch.points) {
        if (stop && *stop) return std::vector<LightByNormal>(result.size());
        const size_t count = std::min(launch.points, result.size() - first);
        if (open > 0) LUCARNE_TRY(send_densities(device, points.subspan(first, count), buffers.grid_));
        LUCARNE_TRY(kernel->run(
            ClRange(count, launch.group), nodes_, lit ? light_ : nodes_, lit, glossy ? lobe_light_ : nodes_,
            glossy ? lobe_directions_ : nodes_, glossy, reach2_ >= 0 ? bright_ : nodes_, reach2_,
            sky.width > 0 ? sky_texels_ : nodes_, sky, open > 0 ? spheres_ : nodes_, open,
            open > 0 ? densities_of_ : nodes_, buffers.points_, rays_, kSets, static_cast<uint32_t>(first),
            static_cast<uint32_t>(count), buffers.seen_, results_));
        if (open == 0) continue;
        each_sky_ray(points.subspan(first, count),
                     [&](size_t i, const glm::vec3& direction, const glm::vec3& light) {
                         by_rays[first + i].add(light_from(direction, points[first + i].normal, light), 1);
                     });
        LUCARNE_TRY(device.finish());
    }
    LUCARNE_TRY(results_.download(0, std::as_writable_bytes(std::span(result))));
    for (size_t i = 0; i < by_rays.size(); ++i) result[i].add(by_rays[i], 1);
    return result;
}

}  // namespace lucarne::gi
