#include "gi/gather/radiosity.h"

#include <algorithm>

#include "gi/shared/brdf.h"
#include "gi/shared/surfel.h"
#include "gi/shared/surfel_code.h"
#include "io/core/parallel.h"
#include "io/core/random.h"

namespace lucarne::gi {
namespace {

constexpr size_t kSurfelsATask = 16384;
/// Micro-buffers of up to so many rays are kept: about 85 MB. More are drawn again for each reflection.
constexpr size_t kMostRaysHeld = size_t{1} << 24;
/// How near other things are is told by micro-buffers of this side, so many at a time.
constexpr uint32_t kTestSide = 4;
constexpr size_t kPointsTested = 65536;

/// Returns the points that gather on both sides of places.
std::vector<GatherPoint> sides_of(const LitTree& scene, const Places& places, uint64_t seed) {
    std::vector<GatherPoint> points;
    for (const uint32_t s : places.surfels) {
        const FlatSurfel& surfel = scene.surfels()[s];
        const glm::vec3 normal = decode_octahedral(surfel.normal);
        for (const float side : {1.0f, -1.0f})
            points.push_back({.position = {surfel.x, surfel.y, surfel.z},
                              .lift = surfel.radius,
                              .normal = side * normal,
                              .seed = static_cast<uint32_t>(mix64(seed, points.size())),
                              .viewer = glm::vec3(0.0f),
                              .exponent = 0,
                              .axis = side * normal,
                              .scale = 1});
    }
    return points;
}

/// Returns the mean of 1 over the distance of what each point sees, 1/m, or zeros if `stop` becomes true.
Result<std::vector<float>> nearness(ClDevice& device, Gatherer& gatherer, std::span<const GatherPoint> points,
                                    uint64_t seed, const std::atomic<bool>* stop) {
    std::vector<float> result;
    result.reserve(points.size());
    MicroBuffers small;
    for (size_t first = 0; first < points.size() && !(stop && *stop); first += kPointsTested) {
        const auto some = points.subspan(first, std::min(kPointsTested, points.size() - first));
        LUCARNE_TRY(gatherer.see(device, some, kTestSide, seed, small, stop));
        LUCARNE_ASSIGN(const auto seen, small.nearness());
        result.insert(result.end(), seen.begin(), seen.end());
    }
    result.resize(points.size());
    return result;
}

}  // namespace

Result<void> Radiosity::choose_places(ClDevice& device, const LitTree& scene, Gatherer& gatherer,
                                      uint32_t level, uint64_t seed, const std::atomic<bool>* stop) {
    if (places_of_.tree.lock() == scene.kept_tree() && places_of_.level == level && places_of_.seed == seed)
        return {};
    places_of_ = {};
    const Places places = gi::choose_places(scene.tree(), scene.surfels(), size_t{1} << level, seed);
    points_ = sides_of(scene, places, seed);
    LUCARNE_ASSIGN(const auto near, nearness(device, gatherer, points_, seed, stop));
    if (stop && *stop) return {};
    sides_ = assign_places(scene.tree(), scene.surfels(), places, near);
    places_of_ = {scene.kept_tree(), level, seed};
    return {};
}

Result<void> Radiosity::gather(ClDevice& device, Gatherer& gatherer, Gathered what, const Settings& settings,
                               std::span<const GatherPoint> points, std::span<glm::vec3> gathered,
                               const std::atomic<bool>* stop) {
    if (points.size() * settings.side * settings.side > kMostRaysHeld) {
        std::vector<glm::vec4> light(points.size());
        LUCARNE_TRY(gatherer.gather(device, what, points, settings.side, settings.seed, light, stop));
        for (size_t i = 0; i < light.size(); ++i) gathered[i] = glm::vec3(light[i]);
        return {};
    }
    LUCARNE_TRY(gatherer.see(device, points, settings.side, settings.seed, buffers_, stop));
    if (stop && *stop) return {};
    LUCARNE_ASSIGN(const auto light, gatherer.shade(device, what, buffers_));
    for (size_t i = 0; i < light.size(); ++i) gathered[i] = light[i].on(points[i].normal);
    return {};
}

Result<void> Radiosity::compute(ClDevice& device, const LitTree& scene, Gatherer& gatherer,
                                const Settings& settings, std::vector<SideLight>& light,
                                const std::atomic<bool>* stop) {
    const auto own = scene.own_light();
    const auto reflectances = scene.reflectances();
    light.assign(own.begin(), own.end());
    std::vector<SideLight> last = light;
    std::vector<glm::vec3> gathered(points_.size(), glm::vec3(0.0f));
    // Returns what a surfel reflects of the light that its places gathered.
    const auto reflected = [&](size_t i) -> SideLight {
        const uint32_t front = sides_[2 * i], back = sides_[2 * i + 1];
        if (front == kNoSurfel) return {};
        return {reflectances[i] * (kPi * gathered[front]), reflectances[i] * (kPi * gathered[back])};
    };
    if (settings.sky) {
        LUCARNE_TRY(gather(device, gatherer, Gathered::sky, settings, points_, gathered, stop));
        if (stop && *stop) return {};
        parallel_ranges(last.size(), kSurfelsATask, [&](size_t first, size_t end) {
            for (size_t i = first; i < end; ++i) {
                const SideLight sky = reflected(i);
                last[i].front += sky.front;
                last[i].back += sky.back;
            }
        });
        light = last;
    }
    for (uint32_t bounce = 0; bounce < settings.bounces; ++bounce) {
        LUCARNE_TRY(gatherer.set_light(device, shared(pull_light(scene.tree(), last))));
        const SideLobes none;
        LUCARNE_TRY(gatherer.set_lobes(device, bounce == 0 ? scene.lobes() : none));
        LUCARNE_TRY(gather(device, gatherer, Gathered::light_of_surfels, settings, points_, gathered, stop));
        if (stop && *stop) return {};
        parallel_ranges(last.size(), kSurfelsATask, [&](size_t first, size_t end) {
            for (size_t i = first; i < end; ++i) {
                last[i] = reflected(i);
                light[i].front += last[i].front;
                light[i].back += last[i].back;
            }
        });
    }
    if (settings.only_last) light = std::move(last);
    return {};
}

}  // namespace lucarne::gi
