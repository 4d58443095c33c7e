#include "gi/gather/radiosity.h"

#include <utility>

#include <glm/geometric.hpp>

#include "gi/gather/places.h"
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

glm::vec3 normal_of(const FlatSurfel& surfel) {
    return decode_octahedral(surfel.normal);
}

}  // namespace

void Radiosity::choose_places(const LitTree& scene, uint32_t level, uint64_t seed) {
    Places places = gi::choose_places(scene.tree(), scene.surfels(), size_t{1} << level, seed);
    place_of_ = std::move(places.place_of);
    points_.clear();
    for (const uint32_t s : places.surfels) {
        const FlatSurfel& surfel = scene.surfels()[s];
        const glm::vec3 normal = normal_of(surfel);
        for (const float side : {1.0f, -1.0f})
            points_.push_back({.position = {surfel.x, surfel.y, surfel.z},
                               .lift = surfel.radius,
                               .normal = side * normal,
                               .seed = 0,
                               .viewer = glm::vec3(0.0f),
                               .exponent = 0,
                               .axis = side * normal,
                               .scale = 1});
    }
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
    std::vector<SideLight> last = light, slots;
    std::vector<GatherPoint> points = points_;
    for (size_t i = 0; i < points.size(); ++i)
        points[i].seed = static_cast<uint32_t>(mix64(settings.seed, i));
    std::vector<glm::vec3> gathered(points.size(), glm::vec3(0.0f));
    // Returns what a surfel reflects of the light that its place gathered.
    const auto reflected = [&](size_t i) -> SideLight {
        const uint32_t place = place_of_[i];
        if (place == kNoSurfel) return {};
        const bool same = glm::dot(normal_of(scene.surfels()[i]), points[2 * place].normal) >= 0;
        const glm::vec3 front = kPi * gathered[2 * place + (same ? 0 : 1)];
        const glm::vec3 back = kPi * gathered[2 * place + (same ? 1 : 0)];
        return {reflectances[i] * front, reflectances[i] * back};
    };
    if (settings.sky) {
        LUCARNE_TRY(gather(device, gatherer, Gathered::sky, settings, points, gathered, stop));
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
        pull_light(scene.tree(), last, slots);
        LUCARNE_TRY(gatherer.set_light(device, slots));
        const SideLobes none;
        LUCARNE_TRY(gatherer.set_lobes(device, bounce == 0 ? scene.lobes() : none));
        LUCARNE_TRY(gather(device, gatherer, Gathered::light_of_surfels, settings, points, gathered, stop));
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
