#include "gi/engines/reference/path_tracer.h"

#include <algorithm>
#include <cmath>

#include <glm/geometric.hpp>

#include "gi/tracing/scatter.h"
#include "io/core/parallel.h"
#include "io/core/progress.h"

namespace lucarne::gi::reference {

using tracing::Incident;
using tracing::light_along;
using tracing::offset_origin;
using tracing::sample_light;
using tracing::scatter;
using tracing::scatter_pdf;
namespace {

constexpr uint32_t kRouletteFrom = 4;  // bounces of every path before Russian roulette may end it
constexpr float kLargestSurvival = 0.95f;
constexpr float kSheetThickness = 4.0f;  // in radii; a noise of one spacing is about two radii
constexpr float kGrazing = 0.1f;         // least cosine when computing how far a sheet extends along a ray
constexpr float kMostShift = 4.0f;  // in radii; beyond that the ray grazes a plane that is hardly the surface

/// Returns the weight of a draw that another strategy draws with the density `other` (balance heuristic).
float balance(float own, float other) {
    return own / (own + other);
}

}  // namespace

struct PathTracer::Vertex {
    glm::vec3 position;
    glm::vec3 normal;  // on the side where the path came from
    glm::vec3 out;     // unit, toward where the path came from
    glm::vec3 origin;  // of rays that leave, one radius above the surface
    glm::vec3 emission;
    float radius;
    Reflectance surface;
};

/// A direction, the density with which the BRDF draws it, and what the ray hits.
struct PathTracer::Ray {
    glm::vec3 direction;
    float pdf;
    const Surfel* hit = nullptr;   // null if nothing is hit
    float distance = 0, side = 0;  // distance to the plane of the hit, cosine to its normal
    glm::vec3 point{0.0f};         // where the ray meets that plane
};

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

/// Returns the reflected light of the sharp lights.
glm::vec3 PathTracer::sharp_light(const Vertex& v) const {
    glm::vec3 sum(0.0f);
    for (const Light& light : light_.sharp_lights()) {
        glm::vec3 in;
        const glm::vec3 irradiance = light_irradiance(light, v.position, v.normal, in);
        if (irradiance != glm::vec3(0.0f) && light_.arrives(light, v.origin, in))
            sum += brdf(v.surface, v.normal, v.out, in) * irradiance;
    }
    return sum;
}

/// Returns the reflected light of areas, caps and the environment: one draw each.
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

/// Returns the weighted light of the same sources along a direction that the BRDF drew.
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

/// Casts a ray. `side` stays 0 if it hits nothing, or a disc edge-on.
PathTracer::Ray PathTracer::cast(const Vertex& from, const glm::vec3& direction, float pdf) const {
    Ray ray{direction, pdf};
    const auto hit = surfels_.nearest(from.origin, direction);
    if (!hit) return ray;
    ray.hit = &surfels_.surfels()[*hit];
    ray.side = -glm::dot(ray.hit->normal, direction);
    if (ray.side == 0) return ray;
    // The plane's own equation is more exact than Embree's distance.
    ray.distance = glm::dot(ray.hit->normal, from.origin - ray.hit->position) / ray.side;
    ray.point = from.origin + direction * ray.distance;
    return ray;
}

/// Returns the vertex where a ray ends. The ray started a radius above its surface to clear it, and so would
/// see everything from a radius nearer. Therefore the vertex is lit at the point where the line from the
/// surface itself meets the plane of the hit. Rays continue from the point that was hit, so that none
/// escapes through a corner.
PathTracer::Vertex PathTracer::arrive(const Vertex& from, const Ray& ray) const {
    const Surfel& surfel = *ray.hit;
    Vertex at = vertex({ray.point, ray.side > 0 ? surfel.normal : -surfel.normal, -ray.direction,
                        surfel.albedo, surfel.radius, surfel.material});
    const float straight = glm::dot(surfel.normal, from.position - surfel.position) / ray.side;
    if (straight > 0 && std::abs(straight - ray.distance) < kMostShift * from.radius)
        at.position = from.position + ray.direction * straight;
    return at;
}

/// Returns the density of a draw. Discs that may have been drawn instead of the one that was hit lie behind
/// it within the noise of their sheet.
SurfelSampler::Density PathTracer::density(const SurfelSampler& sampler, const Vertex& from, const Ray& ray,
                                           uint32_t drawn) const {
    const float behind = kSheetThickness * ray.hit->radius / std::max(std::abs(ray.side), kGrazing);
    const float begin = std::max(0.0f, .999f * ray.distance - ray.hit->radius);  // a margin for rounding
    return sampler.density(from.origin, ray.direction, begin, ray.distance + behind, drawn);
}

/// Draws one surfel and returns its reflected light: emission, or reflected sharp light, depending on
/// `sampler`.
glm::vec3 PathTracer::sampled_surfel(const SurfelSampler& sampler, const Vertex& v, Random& random) const {
    const auto [drawn, point] = sampler.draw(random);
    const glm::vec3 in = glm::normalize(point - v.origin);
    const glm::vec3 f = brdf(v.surface, v.normal, v.out, in);
    if (!(luminance(f) > 0)) return glm::vec3(0.0f);  // also if the point is the origin
    const Ray ray = cast(v, in, scatter_pdf(v.surface, v.normal, v.out, in));
    if (ray.side == 0) return glm::vec3(0.0f);
    const Vertex at = arrive(v, ray);
    const glm::vec3 light = &sampler == &light_.emitters() ? at.emission : sharp_light(at);
    if (light == glm::vec3(0.0f)) return light;
    const auto [pdf, crossed] = density(sampler, v, ray, drawn);
    return crossed ? f * light * (glm::dot(v.normal, in) / (pdf + ray.pdf)) : glm::vec3(0.0f);
}

/// Returns the weighted light of the surface that the BRDF's ray hit.
glm::vec3 PathTracer::met_light(const Vertex& from, const Vertex& at, const Ray& ray) const {
    const auto weighed = [&](const glm::vec3& light, const SurfelSampler& sampler) {
        return light == glm::vec3(0.0f) ? light : light * balance(ray.pdf, density(sampler, from, ray).pdf);
    };
    const glm::vec3 sharp = sharp_light(at);
    return weighed(at.emission, light_.emitters()) +
           (settings_.sample_lit ? weighed(sharp, light_.lit_surfels()) : sharp);
}

/// Returns the sampled light of one path from `first`.
glm::vec3 PathTracer::path(const Vertex& first, Random& random) const {
    glm::vec3 sum(0.0f), throughput(1.0f);
    Vertex at = first;
    const bool sample_lit = settings_.sample_lit && !light_.lit_surfels().empty();
    for (uint32_t bounce = 0;; ++bounce) {
        const bool soft = counts(bounce) && light_.anything_soft();
        if (soft) sum += throughput * soft_light(at, random);
        if (counts(bounce + 1)) {
            if (!light_.emitters().empty()) sum += throughput * sampled_surfel(light_.emitters(), at, random);
            if (sample_lit) sum += throughput * sampled_surfel(light_.lit_surfels(), at, random);
        }
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
        const Ray ray = cast(at, scattered->direction, scattered->pdf);
        if (soft) sum += throughput * soft_light_along(at, ray);
        if (ray.side == 0 || bounce == last_) break;
        const Vertex from = at;
        at = arrive(from, ray);
        if (counts(bounce + 1)) sum += throughput * met_light(from, at, ray);
    }
    return sum;
}

PathSums PathTracer::trace(const Start& start, uint64_t index, const std::atomic<bool>* stop) const {
    PathSums sums;
    const uint64_t samples = std::max(settings_.samples, 1u);
    // With one path a frame the halves alternate.
    const auto half_of = [&](uint64_t sample) { return (settings_.frame * samples + sample) & 1; };
    if (!(start.radius > 0)) {  // black paths: other frames of an average may show a surface here
        for (uint64_t i = 0; anything_random() && i < std::min<uint64_t>(samples, 2); ++i)
            sums.paths[half_of(i)] += (samples + 1 - i) / 2;
        return sums;
    }
    Vertex first = vertex(start);
    first.origin = before_what_hides(surfels_, first.origin, start.viewer, start.normal, start.radius);
    // Emission and sharp light are not sampled: once is enough.
    if (counts(0)) sums.exact = glm::dvec3(first.emission + sharp_light(first));
    if (!anything_random()) return sums;
    const uint64_t key = mix64(mix64(settings_.seed, settings_.frame), index);
    constexpr uint64_t kBetween = 256;  // paths between two looks at `stop`
    for (uint64_t i = 0; i < samples; ++i) {
        if (stop && i % kBetween == 0 && *stop) break;
        Random random(key, i);
        const glm::vec3 light = path(first, random);
        const uint64_t half = half_of(i);
        sums.halves[half] += glm::dvec3(light);
        ++sums.paths[half];
        const double bright = luminance(light);
        sums.luminance += bright;
        sums.squares += bright * bright;
    }
    return sums;
}

std::vector<PathSums> PathTracer::trace(std::span<const Start> starts, Progress* progress,
                                        const std::atomic<bool>* stop) const {
    std::vector<PathSums> sums(starts.size());
    parallel_ranges(starts.size(), 64, [&](size_t first, size_t last) {
        if (stop && *stop) return;
        for (size_t i = first; i < last; ++i) sums[i] = trace(starts[i], i, stop);
        if (progress) progress->add(last - first);
    });
    return sums;
}

}  // namespace lucarne::gi::reference
