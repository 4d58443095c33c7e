#include "gi/reference/path_tracer.h"

#include <algorithm>
#include <cmath>

#include <glm/geometric.hpp>

#include "gi/reference/scatter.h"
#include "gi/shared/light.h"
#include "io/core/parallel.h"

namespace lucarne::gi::reference {
namespace {

constexpr uint32_t kRouletteFrom = 4;  // bounces that every path may take before chance ends it
constexpr float kLargestSurvival = 0.95f;
constexpr float kMostShift = 4.0f;  // radii: beyond that the ray grazes a plane that is hardly the surface

}  // namespace

struct PathTracer::Vertex {
    glm::vec3 position;
    glm::vec3 normal;  // toward where the path came from
    glm::vec3 out;     // likewise, along the ray
    glm::vec3 origin;  // of rays that leave, a radius above
    glm::vec3 emission;
    float radius;
    Reflectance surface;
};

PathTracer::PathTracer(const SurfelTracer& surfels, std::span<const Light> lights,
                       std::span<const Material> materials, const PathSettings& settings)
    : surfels_(surfels), lights_(lights), materials_(materials), settings_(settings) {}

PathTracer::Vertex PathTracer::vertex(const Start& start) const {
    static const Material plain{glm::vec4(1, 1, 1, 0), glm::vec4(0, 0, 0, 1)};
    const Material& material = start.material < materials_.size() ? materials_[start.material] : plain;
    return {start.position,
            start.normal,
            start.viewer,
            offset_origin(start.position, start.normal, start.radius),
            glm::vec3(material.emission.x, material.emission.y, material.emission.z),
            start.radius,
            make_reflectance(material, start.albedo)};
}

bool PathTracer::counts(uint32_t bounce) const {
    return settings_.only_bounce < 0 ? bounce <= settings_.bounces
                                     : bounce == static_cast<uint32_t>(settings_.only_bounce);
}

/// L0: emission and what the spots' light becomes here.
glm::vec3 PathTracer::own_light(const Vertex& v) const {
    glm::vec3 sum = v.emission;
    for (const Light& light : lights_) {
        glm::vec3 in;
        const glm::vec3 irradiance = light_irradiance(light, v.position, v.normal, in);
        if (light.kind > kDirectionalLight || irradiance == glm::vec3(0.0f)) continue;
        const bool hidden = light.kind == kDirectionalLight
                                ? surfels_.nearest(v.origin, in).has_value()
                                : surfels_.occluded(v.origin, glm::vec3(light.position));
        if (hidden) continue;
        sum += brdf(v.surface, v.normal, v.out, in) * irradiance;
    }
    return sum;
}

/// Bounces 1 and up of one path from `first`.
glm::vec3 PathTracer::path(const Vertex& first, Random& random) const {
    const uint32_t last =
        settings_.only_bounce < 0 ? settings_.bounces : static_cast<uint32_t>(settings_.only_bounce);
    glm::vec3 sum(0.0f), throughput(1.0f);
    Vertex at = first;
    for (uint32_t bounce = 1; bounce <= last; ++bounce) {
        if (bounce > kRouletteFrom) {
            const float survival =
                std::min(kLargestSurvival, std::max({throughput.x, throughput.y, throughput.z}));
            if (random.uniform() >= survival) break;
            throughput /= survival;
        }
        const auto scattered = scatter(at.surface, at.normal, at.out, random);
        if (!scattered) break;
        const auto hit = surfels_.nearest(at.origin, scattered->direction);
        if (!hit) break;
        throughput *= scattered->weight;
        const Surfel& surfel = surfels_.surfels()[*hit];
        const glm::vec3 out = -scattered->direction;
        const float side = glm::dot(surfel.normal, out);
        if (side == 0) break;
        // The planes' own equation is more exact than Embree's distance.
        const float lifted = glm::dot(surfel.normal, at.origin - surfel.position) / side;
        const float straight = glm::dot(surfel.normal, at.position - surfel.position) / side;
        const float radius = at.radius;
        const glm::vec3 from = at.position;
        at = vertex({at.origin + scattered->direction * lifted, side > 0 ? surfel.normal : -surfel.normal,
                     out, surfel.albedo, surfel.radius, surfel.material});
        // The ray started a radius above its surface to get clear of it, and would see everything from a
        // radius nearer. So what it met is lit where the line from the surface itself meets that plane; rays
        // go on from what was hit, so that none gets out through a corner.
        if (straight > 0 && std::abs(straight - lifted) < kMostShift * radius)
            at.position = from + scattered->direction * straight;
        if (counts(bounce)) sum += throughput * own_light(at);
    }
    return sum;
}

/// The G-buffer may take a disc's rim that sticks out a little behind another surface (kRimPush). Its rays
/// have to start on the viewer's side of that surface, or the rims of a sealed room would be lit from
/// outside.
glm::vec3 PathTracer::before_what_hides(const glm::vec3& origin, const Start& start) const {
    const auto hit = surfels_.nearest(origin, start.viewer);
    if (!hit) return origin;
    const Surfel& surfel = surfels_.surfels()[*hit];
    const float side = glm::dot(surfel.normal, start.viewer);
    if (side == 0) return origin;
    const float distance = glm::dot(surfel.normal, surfel.position - origin) / side;
    if (distance > 2 * std::max(start.radius, surfel.radius)) return origin;  // something else in front of it
    return offset_origin(origin + start.viewer * distance, side > 0 ? surfel.normal : -surfel.normal,
                         surfel.radius);
}

Estimate PathTracer::trace(const Start& start, uint64_t index) const {
    Estimate result;
    if (!(start.radius > 0)) return result;
    Vertex first = vertex(start);
    first.origin = before_what_hides(first.origin, start);
    const uint64_t key = mix64(mix64(settings_.seed, settings_.frame), index);
    const uint32_t samples = std::max(settings_.samples, 1u);
    const bool indirect = settings_.only_bounce < 0 ? settings_.bounces > 0 : settings_.only_bounce > 0;
    if (indirect) {
        // Welford's running mean and sum of squared differences.
        glm::dvec3 mean(0.0);
        double luminance_mean = 0, squares = 0;
        for (uint32_t i = 0; i < samples; ++i) {
            Random random(key, i);
            const glm::vec3 light = path(first, random);
            mean += (glm::dvec3(light) - mean) / (i + 1.0);
            const double difference = luminance(light) - luminance_mean;
            luminance_mean += difference / (i + 1.0);
            squares += difference * (luminance(light) - luminance_mean);
        }
        result.radiance = glm::vec3(mean);
        if (samples > 1) result.variance = static_cast<float>(squares / (samples - 1.0) / samples);
    }
    // Light from spots has no chance in it: once is enough.
    if (counts(0)) result.radiance += own_light(first);
    return result;
}

std::vector<Estimate> PathTracer::trace(std::span<const Start> starts) const {
    std::vector<Estimate> estimates(starts.size());
    parallel_ranges(starts.size(), 64, [&](size_t first, size_t last) {
        for (size_t i = first; i < last; ++i) estimates[i] = trace(starts[i], i);
    });
    return estimates;
}

MeanLuminance mean_luminance(std::span<const Estimate> estimates) {
    MeanLuminance result;
    if (estimates.empty()) return result;
    double variance = 0;
    for (const Estimate& e : estimates) {
        result.mean += luminance(e.radiance);
        variance += e.variance;
    }
    const auto count = static_cast<double>(estimates.size());
    result.mean /= count;
    result.standard_error = std::sqrt(variance) / count;
    return result;
}

}  // namespace lucarne::gi::reference
