#include "gi/gather/gatherer.h"

#include <algorithm>
#include <cmath>
#include <numeric>

#include <fmt/format.h>

#include "gi/gather/point_groups.h"
#include "gi/shared/brdf.h"
#include "io/core/parallel.h"
#include "io/core/random.h"

namespace lucarne::gi {
namespace {

constexpr const char* kSource = "gi/gather/gather.cl";
constexpr uint32_t kSets = 32;  // of rays; points choose among them
constexpr float kNoRay = 2;     // as x
constexpr size_t kPointsATask = 64;
/// How far away most of what points see is, over the size of the largest surface.
constexpr float kUsualReach = 0.25f;
constexpr double kRim = 1 - 1e-6;  // rays in the plane of the surface would meet it
/// Points of one run of the kernel, short enough for displays' watchdogs and to be stopped in between; those
/// that a work-item draws at once; work-items of a group. A GPU has a vector of work-items, so each draws for
/// one point.
struct Launch {
    size_t points, lanes, group;
};
constexpr Launch kOnProcessor{4096, kGroupedPoints, 1}, kOnGpu{65536, 1, 32};
/// What needs no lanes, such as points that are drawn one by one.
constexpr size_t kOneLane = 1;

const Launch& launch_of(const ClDevice& device) {
    return device.info().is_gpu ? kOnGpu : kOnProcessor;
}

/// A disc in a square holds pi / 4 of its pixels.
uint32_t grid_for(uint32_t side) {
    return static_cast<uint32_t>(std::lround(side * std::sqrt(4 / M_PI)));
}

Defines defines_for(uint32_t grid, size_t lanes, Fill fill = Fill::rays) {
    return {{"LUCARNE_GRID", fmt::format("{}", grid)},
            {"LUCARNE_LANES", fmt::format("{}", lanes)},
            {"LUCARNE_FILL_PIXELS", fill == Fill::pixels ? "1" : "0"}};
}

/// Returns what a device draws at once: on a GPU single points.
PointGroups groups_for(const Launch& launch, std::span<const GatherPoint> points, float reach) {
    if (launch.lanes > 1) return group_points(points, reach);
    PointGroups groups;
    groups.order.resize(points.size());
    std::iota(groups.order.begin(), groups.order.end(), 0u);
    groups.first.resize(points.size() + 1);
    std::iota(groups.first.begin(), groups.first.end(), 0u);
    return groups;
}

std::vector<GatherPoint> in_order(std::span<const GatherPoint> points, std::span<const uint32_t> order) {
    std::vector<GatherPoint> result;
    result.reserve(order.size());
    for (const uint32_t number : order) result.push_back(points[number]);
    return result;
}

/// Gives the points of each group the same seed / kSets, by which their pictures are turned, so that each of
/// them sees a node at about the same pixels. `first`: where groups begin, and the end.
void turn_alike(std::span<GatherPoint> points, std::span<const uint32_t> first) {
    for (size_t group = 0; group + 1 < first.size(); ++group) {
        const uint32_t turn = points[first[group]].seed / kSets * kSets;
        for (uint32_t i = first[group]; i < first[group + 1]; ++i)
            points[i].seed = turn + points[i].seed % kSets;
    }
}

/// Calls body(begin, end, lanes) for the groups of each launch until one fails.
template <class Body>
Result<void> for_each_launch(const Launch& launch, const PointGroups& groups, const Body& body) {
    for (size_t begin = 0; begin + 1 < groups.first.size();) {
        size_t end = begin + 1;
        const size_t last = begin < groups.full ? groups.full : groups.first.size() - 1;
        while (end < last && groups.first[end + 1] - groups.first[begin] <= launch.points) ++end;
        LUCARNE_TRY(body(begin, end, begin < groups.full ? launch.lanes : kOneLane));
        begin = end;
    }
    return {};
}

}  // namespace

Result<std::vector<uint32_t>> MicroBuffers::seen() const {
    const size_t pixels = size_t{grid_} * grid_;
    std::vector<uint32_t> drawn(count_ * pixels), result(drawn.size());
    if (count_ > 0) LUCARNE_TRY(seen_.download(0, std::as_writable_bytes(std::span(drawn))));
    for (size_t i = 0; i < count_; ++i) std::copy_n(&drawn[i * pixels], pixels, &result[order_[i] * pixels]);
    return result;
}

Result<std::vector<float>> MicroBuffers::nearness() const {
    std::vector<float> drawn(count_), result(count_);
    if (count_ > 0) LUCARNE_TRY(nearness_.download(0, std::as_writable_bytes(std::span(drawn))));
    for (size_t i = 0; i < count_; ++i) result[order_[i]] = drawn[i];
    return result;
}

Result<void> Gatherer::set_tree(ClDevice& device, const std::shared_ptr<const SurfelTree>& tree) {
    ++tree_;
    set_no_bright();
    openings_ = nullptr;
    empty_ = !tree || tree->empty();
    reach_ = 0;
    for (size_t k = 0; !empty_ && k < 8; ++k)
        if (tree->nodes[0].child[k] != kNoChild)
            reach_ = std::max(reach_, kUsualReach * tree->nodes[0].bound[k]);
    if (!empty_) return device.lend(nodes_, std::as_bytes(std::span(tree->nodes)), tree, "tree of surfels");
    const auto nothing = std::make_shared<const WideNode>(empty_node());
    return device.lend(nodes_, std::as_bytes(std::span(nothing.get(), 1)), nothing, "tree of surfels");
}

Result<void> Gatherer::set_light(ClDevice& device, SharedLight slots) {
    set_no_bright();
    typical_ = 0;
    if (slots->empty()) return {};
    const auto bytes = std::as_bytes(std::span(*slots));
    return device.lend(light_, bytes, std::move(slots), "light of the tree");
}

Result<void> Gatherer::set_bright(ClDevice& device, SharedLight slots, float reach2) {
    const auto bytes = std::as_bytes(std::span(*slots));
    LUCARNE_TRY(device.lend(bright_, bytes, std::move(slots), "bright light of the tree"));
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
    const size_t pixels = size_t{grid} * grid;
    std::vector<float> rays(kSets * 2 * pixels, kNoRay);
    Random random(seed, grid);
    for (size_t set = 0; set < kSets; ++set)
        for (size_t j = 0; j < grid; ++j)
            for (size_t i = 0; i < grid; ++i) {
                const double x = 2 * (static_cast<double>(i) + random.uniform()) / grid - 1;
                const double y = 2 * (static_cast<double>(j) + random.uniform()) / grid - 1;
                if (x * x + y * y >= kRim) continue;
                float* ray = &rays[set * 2 * pixels + j * grid + i];
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
    const Asked wanted = asked(what);
    const uint32_t lit = wanted.lit, glossy = wanted.glossy, open = wanted.open;
    const SkyPicture& sky = wanted.sky;
    const uint32_t grid = grid_for(side);
    LUCARNE_TRY(make_rays(device, grid, seed));
    const Launch& launch = launch_of(device);
    const PointGroups groups = groups_for(launch, points, reach_);
    std::vector<glm::vec4> found;
    std::vector<uint32_t> firsts;
    size_t finished = 0;
    return for_each_launch(launch, groups, [&](size_t begin, size_t end, size_t lanes) -> Result<void> {
        if (stop && *stop) return {};
        LUCARNE_ASSIGN(const ClKernel* kernel,
                       device.kernel(kSource, "gather", defines_for(grid, lanes, fill)));
        firsts.assign(&groups.first[begin], &groups.first[end] + 1);
        const auto numbers = std::span(groups.order).subspan(firsts[0], firsts.back() - firsts[0]);
        for (const uint32_t base = firsts[0]; uint32_t & first : firsts) first -= base;
        const std::vector<GatherPoint> some = in_order(points, numbers);
        if (open > 0) LUCARNE_TRY(send_densities(device, some, grid));
        LUCARNE_TRY(send_points(device, some, firsts, points_));
        LUCARNE_TRY(device.reserve(results_, some.size() * sizeof(glm::vec4), "gathered light"));
        const size_t count = end - begin;
        LUCARNE_TRY(kernel->run(ClRange(count, launch.group), nodes_, lit ? light_ : nodes_, lit, typical_,
                                glossy ? lobe_light_ : nodes_, glossy ? lobe_directions_ : nodes_, glossy,
                                reach2_ >= 0 ? bright_ : nodes_, reach2_,
                                sky.width > 0 ? sky_texels_ : nodes_, sky, open > 0 ? spheres_ : nodes_, open,
                                open > 0 ? densities_of_ : nodes_, points_, rays_, kSets, groups_,
                                static_cast<uint32_t>(count), results_));
        found.resize(some.size());
        LUCARNE_TRY(results_.download(0, std::as_writable_bytes(std::span(found))));
        for (size_t i = 0; i < found.size(); ++i) results[numbers[i]] = found[i];
        if (open > 0)
            each_sky_ray(some, [&](size_t i, const glm::vec3&, const glm::vec3& light) {
                results[numbers[i]] += glm::vec4(light, 0);
            });
        finished += found.size();
        if (done) done(finished);
        return {};
    });
}

Result<void> Gatherer::send_points(ClDevice& device, std::vector<GatherPoint> points,
                                   std::span<const uint32_t> first, ClBuffer& to) {
    turn_alike(points, first);
    LUCARNE_TRY(device.reserve(to, points.size() * sizeof(GatherPoint), "gather points"));
    LUCARNE_TRY(device.reserve(groups_, first.size_bytes(), "groups of gather points"));
    LUCARNE_TRY(to.upload(0, std::as_bytes(std::span(points))));
    return groups_.upload(0, std::as_bytes(first));
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
    ++buffers.drawing_;
    buffers.held_.assign(points.begin(), points.end());
    if (points.empty()) return {};
    LUCARNE_TRY(make_rays(device, grid, seed));
    const Launch& launch = launch_of(device);
    const PointGroups groups = groups_for(launch, points, reach_);
    buffers.order_ = groups.order;
    const size_t count = points.size(), pixels = size_t{grid} * grid;
    LUCARNE_TRY(device.reserve(buffers.seen_, count * pixels * sizeof(uint32_t), "micro-buffers"));
    LUCARNE_TRY(device.reserve(buffers.nearness_, count * sizeof(float), "distances"));
    LUCARNE_TRY(send_points(device, in_order(points, groups.order), groups.first, buffers.points_));
    const auto see_groups = [&](size_t begin, size_t end, size_t lanes) -> Result<void> {
        if (stop && *stop) return {};
        LUCARNE_ASSIGN(const ClKernel* kernel, device.kernel(kSource, "see", defines_for(grid, lanes)));
        LUCARNE_TRY(kernel->run(ClRange(end - begin, launch.group), nodes_, buffers.points_, rays_, kSets,
                                groups_, static_cast<uint32_t>(begin), static_cast<uint32_t>(end - begin),
                                buffers.seen_, buffers.nearness_));
        if (stop) LUCARNE_TRY(device.finish());
        return {};
    };
    LUCARNE_TRY(for_each_launch(launch, groups, see_groups));
    if (stop && *stop) return {};
    buffers.count_ = count;
    buffers.grid_ = grid;
    buffers.seed_ = seed;
    buffers.tree_ = tree_;
    return {};
}

template <class Light>
Result<std::vector<Light>> Gatherer::light_buffers(ClDevice& device, const char* kernel_name, Gathered what,
                                                   const MicroBuffers& buffers,
                                                   const std::atomic<bool>* stop) {
    std::vector<Light> result(buffers.count());
    if (result.empty()) return result;
    const auto [lit, glossy, sky, open] = asked(what);
    LUCARNE_TRY(make_rays(device, buffers.grid_, buffers.seed_));
    const Launch& launch = launch_of(device);
    LUCARNE_ASSIGN(const ClKernel* kernel,
                   device.kernel(kSource, kernel_name, defines_for(buffers.grid_, kOneLane)));
    const std::vector<GatherPoint> points = in_order(buffers.held_, buffers.order_);
    std::vector<Light> drawn(std::min(launch.points, result.size()));
    LUCARNE_TRY(device.reserve(results_, drawn.size() * sizeof(Light), "gathered light"));
    for (size_t first = 0; first < result.size(); first += launch.points) {
        if (stop && *stop) return std::vector<Light>(result.size());
        const size_t count = std::min(launch.points, result.size() - first);
        const auto some = std::span(points).subspan(first, count);
        if (open > 0) LUCARNE_TRY(send_densities(device, some, buffers.grid_));
        LUCARNE_TRY(kernel->run(
            ClRange(count, launch.group), nodes_, lit ? light_ : nodes_, lit, glossy ? lobe_light_ : nodes_,
            glossy ? lobe_directions_ : nodes_, glossy, reach2_ >= 0 ? bright_ : nodes_, reach2_,
            sky.width > 0 ? sky_texels_ : nodes_, sky, open > 0 ? spheres_ : nodes_, open,
            open > 0 ? densities_of_ : nodes_, buffers.points_, rays_, kSets, static_cast<uint32_t>(first),
            static_cast<uint32_t>(count), buffers.seen_, results_));
        drawn.resize(count);
        LUCARNE_TRY(results_.download(0, std::as_writable_bytes(std::span(drawn))));
        if (open > 0)
            each_sky_ray(some, [&](size_t i, const glm::vec3& direction, const glm::vec3& light) {
                drawn[i].add_ray(some[i].normal, direction, light);
            });
        for (size_t i = 0; i < count; ++i) result[buffers.order_[first + i]] = drawn[i];
    }
    return result;
}

Result<std::vector<LightByNormal>> Gatherer::shade(ClDevice& device, Gathered what,
                                                   const MicroBuffers& buffers,
                                                   const std::atomic<bool>* stop) {
    return light_buffers<LightByNormal>(device, "shade", what, buffers, stop);
}

Result<std::vector<LightByDirection>> Gatherer::shade_by_direction(ClDevice& device, Gathered what,
                                                                   const MicroBuffers& buffers,
                                                                   const std::atomic<bool>* stop) {
    return light_buffers<LightByDirection>(device, "sort_by_direction", what, buffers, stop);
}

}  // namespace lucarne::gi
