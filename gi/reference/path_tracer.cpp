#include "gi/reference/path_tracer.h"

#include <algorithm>
#include <cmath>

#include <glm/geometric.hpp>

#include "gi/reference/scatter.h"
#include "io/core/parallel.h"
#include "io/core/progress.h"

namespace lucarne::gi::reference {
namespace {

constexpr uint32_t kRouletteFrom = 4;  // bounces that every path may take before chance ends it
constexpr float kLargestSurvival = 0.95f;
constexpr float kMostShift = 4.0f;  // radii: beyond that the ray grazes a plane that is hardly the surface

/// The weight of a draw that another way draws with the density `other` (balance heuristic).
float balance(float own, float other) {
    return own / (own + other);
}

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

/// A direction that the BRDF drew, and what it met.
struct PathTracer::Ray {
    glm::vec3 direction;
    float pdf;
    const Surfel* hit;     // or none
    float distance, side;  // of the hit's plane from the origin; cosine to its normal
};

void PathSums::add(const PathSums& other) {
    exact = other.exact;
    for (int half = 0; half < 2; ++half) {
        halves[half] += other.halves[half];
        paths[half] += other.paths[half];
    }
    luminance += other.luminance;
    squares += other.squares;
}

glm::vec3 PathSums::radiance() const {
    const auto all = static_cast<double>(std::max<uint64_t>(paths[0] + paths[1], 1));
    return glm::vec3(exact + (halves[0] + halves[1]) / all);
}

glm::vec3 PathSums::half_radiance(int half) const {
    return paths[half] ? glm::vec3(exact + halves[half] / static_cast<double>(paths[half])) : radiance();
}

float PathSums::variance() const {
    const auto n = static_cast<double>(paths[0] + paths[1]);
    if (n < 2) return 0;
    const double spread = std::max(0.0, squares - luminance * luminance / n) / (n - 1);
    return static_cast<float>(spread / n);
}

PathTracer::PathTracer(const Illumination& illumination, const PathSettings& settings)
    : light_(illumination),
      surfels_(illumination.surfels()),
      settings_(settings),
      last_(settings.only_bounce < 0 ? settings.bounces : static_cast<uint32_t>(settings.only_bounce)) {}

PathTracer::Vertex PathTracer::vertex(const Start& start) const {
    const Material& material = light_.material(start.material);
    return {start.position,
            start.normal,
            start.viewer,
            offset_origin(start.position, start.normal, start.radius),
            glm::vec3(material.emission.x, material.emission.y, material.emission.z),
            start.radius,
            make_reflectance(material, start.albedo)};
}

bool PathTracer::counts(uint32_t bounce) const {
    return settings_.only_bounce < 0 ? bounce <= last_ : bounce == last_;
}

bool PathTracer::anything_random() const {
    return last_ > 0 || light_.anything_soft();
}

/// What light from single directions becomes here.
glm::vec3 PathTracer::sharp_light(const Vertex& v) const {
    glm::vec3 sum(0.0f);
    for (const Light& light : light_.sharp_lights()) {
        glm::vec3 in;
        const glm::vec3 irradiance = light_irradiance(light, v.position, v.normal, in);
        if (irradiance == glm::vec3(0.0f)) continue;
        const bool hidden = light.kind == kDirectionalLight
                                ? surfels_.occluded_along(v.origin, in)
                                : surfels_.occluded(v.origin, glm::vec3(light.position));
        if (!hidden) sum += brdf(v.surface, v.normal, v.out, in) * irradiance;
    }
    return sum;
}

/// Likewise from areas, caps and the environment: one draw each.
glm::vec3 PathTracer::soft_light(const Vertex& v, Random& random) const {
    glm::vec3 sum(0.0f);
    const auto add = [&](const Incident& in) {
        const glm::vec3 reflected = brdf(v.surface, v.normal, v.out, in.direction) *
                                    (glm::dot(v.normal, in.direction) / in.pdf) * in.radiance;
        if (!(luminance(reflected) > 0)) return;
        const bool hidden = std::isinf(in.distance)
                                ? surfels_.occluded_along(v.origin, in.direction)
                                : surfels_.occluded(v.origin, v.position + in.direction * in.distance);
        if (!hidden)
            sum += reflected * balance(in.pdf, scatter_pdf(v.surface, v.normal, v.out, in.direction));
    };
    for (const Light& light : light_.soft_lights())
        if (const auto in = sample_light(light, v.position, random)) add(*in);
    if (light_.environment()) add(light_.environment()->sample(random));
    return sum;
}

/// What arrives of the same along a direction that the BRDF drew, weighted.
glm::vec3 PathTracer::soft_light_along(const Vertex& v, const Ray& ray) const {
    glm::vec3 sum(0.0f);
    for (const Light& light : light_.soft_lights()) {
        const auto in = light_along(light, v.position, ray.direction);
        if (!in) continue;
        const bool hidden = std::isinf(in->distance)
                                ? ray.hit != nullptr
                                : surfels_.occluded(v.origin, v.position + ray.direction * in->distance);
        if (!hidden) sum += in->radiance * balance(ray.pdf, in->pdf);
    }
    if (light_.environment() && !ray.hit) {
        const Incident in = light_.environment()->along(ray.direction);
        sum += in.radiance * balance(ray.pdf, in.pdf);
    }
    return sum;
}

/// What one emitting surfel's light becomes here; see Illumination for the rule by which it counts.
glm::vec3 PathTracer::sampled_emission(const Vertex& v, Random& random) const {
    const auto [index, point] = light_.sample_emitter(random);
    const Surfel& surfel = surfels_.surfels()[index];
    const glm::vec3 offset = point - v.origin;
    const float distance = glm::length(offset);
    if (!(distance > 0)) return glm::vec3(0.0f);
    const glm::vec3 in = offset / distance;
    const float cosine = std::abs(glm::dot(surfel.normal, in));
    const glm::vec3 f = brdf(v.surface, v.normal, v.out, in);
    if (!(cosine > 0) || f == glm::vec3(0.0f) || surfels_.nearest(v.origin, in) != index)
        return glm::vec3(0.0f);
    const float pdf = light_.emitter_pdf(surfel, distance, cosine);
    const float weight = balance(pdf, scatter_pdf(v.surface, v.normal, v.out, in)) / pdf;
    return f * (glm::dot(v.normal, in) * weight) * glm::vec3(light_.material(surfel.material).emission);
}

/// The emission of what a ray of the BRDF met.
glm::vec3 PathTracer::weighed_emission(const Vertex& at, const Ray& ray) const {
    if (at.emission == glm::vec3(0.0f)) return glm::vec3(0.0f);
    return at.emission * balance(ray.pdf, light_.emitter_pdf(*ray.hit, ray.distance, std::abs(ray.side)));
}

/// The vertex where a ray ends. It started a radius above its surface to get clear of it, and would see
/// everything from a radius nearer. So what it met is lit where the line from the surface itself meets that
/// plane; rays go on from what was hit, so that none gets out through a corner.
PathTracer::Vertex PathTracer::arrive(const Vertex& from, const Ray& ray) const {
    const Surfel& surfel = *ray.hit;
    Vertex at =
        vertex({from.origin + ray.direction * ray.distance, ray.side > 0 ? surfel.normal : -surfel.normal,
                -ray.direction, surfel.albedo, surfel.radius, surfel.material});
    const float straight = glm::dot(surfel.normal, from.position - surfel.position) / ray.side;
    if (straight > 0 && std::abs(straight - ray.distance) < kMostShift * from.radius)
        at.position = from.position + ray.direction * straight;
    return at;
}

/// All light of one path from `first` that has chance in it.
glm::vec3 PathTracer::path(const Vertex& first, Random& random) const {
    glm::vec3 sum(0.0f), throughput(1.0f);
    Vertex at = first;
    for (uint32_t bounce = 0;; ++bounce) {
        if (bounce > 0 && counts(bounce)) sum += throughput * sharp_light(at);
        const bool soft = counts(bounce) && light_.anything_soft();
        if (soft) sum += throughput * soft_light(at, random);
        if (counts(bounce + 1) && light_.has_emitters()) sum += throughput * sampled_emission(at, random);
        if (bounce == last_ && !soft) break;
        if (bounce >= kRouletteFrom) {
            const float survival =
                std::min(kLargestSurvival, std::max({throughput.x, throughput.y, throughput.z}));
            if (random.uniform() >= survival) break;
            throughput /= survival;
        }
        const auto scattered = scatter(at.surface, at.normal, at.out, random);
        if (!scattered) break;
        throughput *= scattered->weight;
        const auto hit = surfels_.nearest(at.origin, scattered->direction);
        Ray ray{scattered->direction, scattered->pdf, hit ? &surfels_.surfels()[*hit] : nullptr, 0, 0};
        if (soft) sum += throughput * soft_light_along(at, ray);
        if (!hit || bounce == last_) break;
        // The plane's own equation is more exact than Embree's distance.
        ray.side = -glm::dot(ray.hit->normal, ray.direction);
        if (ray.side == 0) break;
        ray.distance = glm::dot(ray.hit->normal, at.origin - ray.hit->position) / ray.side;
        at = arrive(at, ray);
        if (counts(bounce + 1)) sum += throughput * weighed_emission(at, ray);
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

PathSums PathTracer::trace(const Start& start, uint64_t index) const {
    PathSums sums;
    if (!(start.radius > 0)) return sums;
    Vertex first = vertex(start);
    first.origin = before_what_hides(first.origin, start);
    // Emission and light from single directions have no chance in them: once is enough.
    if (counts(0)) sums.exact = glm::dvec3(first.emission + sharp_light(first));
    if (!anything_random()) return sums;
    const uint64_t key = mix64(mix64(settings_.seed, settings_.frame), index);
    const uint64_t samples = std::max(settings_.samples, 1u);
    for (uint64_t i = 0; i < samples; ++i) {
        Random random(key, i);
        const glm::vec3 light = path(first, random);
        const uint64_t half = (settings_.frame * samples + i) & 1;  // single paths take turns frame by frame
        sums.halves[half] += glm::dvec3(light);
        ++sums.paths[half];
        const double bright = luminance(light);
        sums.luminance += bright;
        sums.squares += bright * bright;
    }
    return sums;
}

std::vector<PathSums> PathTracer::trace(std::span<const Start> starts, Progress* progress) const {
    std::vector<PathSums> sums(starts.size());
    parallel_ranges(starts.size(), 64, [&](size_t first, size_t last) {
        for (size_t i = first; i < last; ++i) sums[i] = trace(starts[i], i);
        if (progress) progress->add(last - first);
    });
    return sums;
}

MeanLuminance mean_luminance(std::span<const PathSums> sums) {
    MeanLuminance result;
    if (sums.empty()) return result;
    double variance = 0;
    for (const PathSums& s : sums) {
        result.mean += luminance(s.radiance());
        variance += s.variance();
    }
    const auto count = static_cast<double>(sums.size());
    result.mean /= count;
    result.standard_error = std::sqrt(variance) / count;
    return result;
}

}  // namespace lucarne::gi::reference
