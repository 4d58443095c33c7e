#include "gi/gather/sky_openings.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <functional>
#include <limits>
#include <utility>

#include <glm/common.hpp>
#include <glm/geometric.hpp>
#include <glm/vec2.hpp>

#include "gi/gather/traced_tree.h"
#include "gi/lighting/area_points.h"
#include "gi/shared/lobe.h"
#include "gi/tracing/light_sampling.h"
#include "gi/tracing/scatter.h"
#include "io/core/parallel.h"
#include "io/core/random.h"

namespace lucarne::gi {
namespace {

constexpr size_t kMostOpenings = 256, kPilotsATask = 8;
constexpr uint32_t kRaysOfAPilot = 256;  ///< that look for the sky
/// Rays about one that meets nothing: the sines of the angles between, and how many there are at each.
constexpr std::array kRings{0.017f, 0.035f, 0.07f, 0.14f, 0.28f};
constexpr uint32_t kRaysOfARing = 8;
constexpr uint32_t kRaysATest = 4;  ///< that tell how much of a sphere a pilot sees
/// Radii of spheres: at least this share of the openings' median distance, and larger than what the rays that
/// found them took up.
constexpr double kLeastShareOfDistance = 1.0 / 48;
constexpr float kMargin = 1.1f;
/// A sphere counts for points outside of so many of its radii.
constexpr float kNear = 1.5f;
constexpr size_t kPilotsAbout = 4;  ///< that tell what a point sees of the spheres
/// Share of a sphere that is taken as seen though no pilot about a point sees it.
constexpr float kUnseen = 0.05f;

glm::dvec2 random_shift(Random& random) {
    const double x = random.uniform();
    return {x, random.uniform()};
}

/// A sphere as a point sees it.
struct Cone {
    glm::vec3 middle;  ///< from the point, m
    float radius2 = 0;
    float height = 0;  ///< 1 - cosine of the half angle: the solid angle is 2 pi times it; 0: does not count

    /// As gather.cl has it; by the sine, because cosines of narrow cones are lost in rounding.
    bool holds(const glm::vec3& direction) const {
        const glm::vec3 beside = glm::cross(direction, middle);
        return height > 0 && glm::dot(direction, middle) > 0 && glm::dot(beside, beside) < radius2;
    }
    glm::vec3 draw(const glm::dvec2& square) const {
        const float low = height * static_cast<float>(square.x);
        const float sine = std::sqrt(std::max(low * (2 - low), 0.0f));
        const auto phi = static_cast<float>(2 * M_PI * square.y);
        const glm::vec3 axis = glm::normalize(middle);
        glm::vec3 tangent, bitangent;
        tracing::frame_of(axis, tangent, bitangent);
        return tangent * (sine * std::cos(phi)) + bitangent * (sine * std::sin(phi)) + axis * (1 - low);
    }
};

/// Sphere and point as gather.cl has them.
Cone cone_of(const glm::vec4& sphere, const glm::vec3& point) {
    Cone cone{.middle = glm::vec3(sphere) - point};
    const float distance2 = glm::dot(cone.middle, cone.middle);
    cone.radius2 = sphere.w * sphere.w;
    if (!(distance2 > kNear * kNear * cone.radius2)) return cone;
    const float sine2 = cone.radius2 / distance2;
    cone.height = sine2 / (1 + std::sqrt(1 - sine2));
    return cone;
}

/// Returns the largest cosine between a normal and a direction of a cone; 0 if all are below the surface.
float largest_cosine(const Cone& cone, const glm::vec3& normal) {
    const float cosine = glm::dot(cone.middle, normal) / glm::length(cone.middle);
    const float c = 1 - cone.height, s = std::sqrt(std::max(cone.height * (2 - cone.height), 0.0f));
    if (cosine >= c) return 1;
    return std::max(cosine * c + std::sqrt(std::max(1 - cosine * cosine, 0.0f)) * s, 0.0f);
}

/// The sky seen through an opening.
struct SkyRay {
    glm::vec3 place;  ///< about where it passes the opening, m
    glm::vec3 direction;
};

/// Returns how far away an opening is through which a ray passes: as far as what surrounds it. 0: nothing
/// does.
float distance_of_opening(const tracing::SurfelTracer& tracer, const glm::vec3& start, const glm::vec3& ray) {
    glm::vec3 tangent, bitangent;
    tracing::frame_of(ray, tangent, bitangent);
    for (const float sine : kRings) {
        float farthest = 0;
        for (uint32_t i = 0; i < kRaysOfARing; ++i) {
            const auto angle = static_cast<float>(2 * M_PI * i / kRaysOfARing);
            const glm::vec3 beside = tangent * std::cos(angle) + bitangent * std::sin(angle);
            const auto hit = tracer.first_hit(start, ray * std::sqrt(1 - sine * sine) + beside * sine);
            if (hit) farthest = std::max(farthest, hit->distance);
        }
        if (farthest > 0) return farthest;
    }
    return 0;
}

/// Returns those rays of a pilot that meet nothing.
std::vector<glm::vec3> free_rays(const tracing::SurfelTracer& tracer, const GatherPoint& pilot,
                                 const glm::vec3& start, Random random) {
    std::vector<glm::vec3> rays;
    const glm::dvec2 shift = random_shift(random);
    for (uint32_t i = 0; i < kRaysOfAPilot; ++i) {
        const glm::vec3 ray =
            tracing::cosine_power_direction(pilot.normal, 1, lattice_point(i, kRaysOfAPilot, shift));
        if (!tracer.occluded_along(start, ray)) rays.push_back(ray);
    }
    return rays;
}

/// Rays through openings that are near each other.
struct Cluster {
    std::vector<SkyRay> rays;
    glm::vec3 low, high;  ///< box of their places

    explicit Cluster(std::vector<SkyRay> all) : rays(std::move(all)), low(rays[0].place), high(low) {
        for (const SkyRay& ray : rays) {
            low = glm::min(low, ray.place);
            high = glm::max(high, ray.place);
        }
    }
    /// Clusters of many rays that are far apart are divided first.
    double weight() const {
        const glm::dvec3 size = high - low;
        return static_cast<double>(rays.size()) * glm::dot(size, size);
    }
};

/// Returns at most kMostOpenings clusters of rays.
std::vector<Cluster> clusters_of(std::vector<SkyRay> rays) {
    std::vector<Cluster> clusters{Cluster(std::move(rays))};
    while (clusters.size() < kMostOpenings) {
        const auto largest = std::ranges::max_element(clusters, {}, &Cluster::weight);
        if (!(largest->weight() > 0)) break;
        const glm::vec3 size = largest->high - largest->low;
        const int axis = size.x >= size.y && size.x >= size.z ? 0 : size.y >= size.z ? 1 : 2;
        const float middle = 0.5f * (largest->low[axis] + largest->high[axis]);
        std::vector<SkyRay> below, above;
        for (const SkyRay& ray : largest->rays) (ray.place[axis] < middle ? below : above).push_back(ray);
        if (below.empty() || above.empty()) {  // neighbouring floats
            largest->high = largest->low;
            continue;
        }
        *largest = Cluster(std::move(below));
        clusters.emplace_back(std::move(above));
    }
    return clusters;
}

}  // namespace

SkyOpenings SkyOpenings::find(const tracing::SurfelTracer& tracer, const GatherSky& sky,
                              std::span<const GatherPoint> pilots, uint64_t seed,
                              const std::atomic<bool>* stop) {
    SkyOpenings openings;
    if (sky.texels.empty() || pilots.empty()) return openings;
    std::vector<glm::vec3> starts(pilots.size());
    std::vector<std::vector<glm::vec3>> free(pilots.size());
    parallel_ranges(pilots.size(), kPilotsATask, [&](size_t first, size_t last) {
        for (size_t i = first; i < last && !(stop && *stop); ++i) {
            starts[i] = ray_start(tracer, pilots[i]);
            free[i] = free_rays(tracer, pilots[i], starts[i], Random(seed, i));
        }
    });
    size_t open = 0;
    for (const std::vector<glm::vec3>& of_pilot : free) open += of_pilot.size();
    if (static_cast<double>(open) > kWide * static_cast<double>(pilots.size() * kRaysOfAPilot))
        return openings;
    std::vector<std::vector<SkyRay>> found(pilots.size());
    parallel_ranges(pilots.size(), kPilotsATask, [&](size_t first, size_t last) {
        for (size_t i = first; i < last && !(stop && *stop); ++i)
            for (const glm::vec3& ray : free[i]) {
                const float distance = distance_of_opening(tracer, starts[i], ray);
                if (distance > 0) found[i].push_back({starts[i] + distance * ray, ray});
            }
    });
    std::vector<SkyRay> rays;
    std::vector<double> distances;
    for (size_t i = 0; i < pilots.size(); ++i)
        for (const SkyRay& ray : found[i]) {
            rays.push_back(ray);
            distances.push_back(glm::distance(ray.place, starts[i]));
        }
    if (rays.empty() || (stop && *stop)) return openings;
    const auto middle = distances.begin() + static_cast<std::ptrdiff_t>(distances.size() / 2);
    std::nth_element(distances.begin(), middle, distances.end());
    const auto least = static_cast<float>(kLeastShareOfDistance * *middle);
    for (const Cluster& cluster : clusters_of(std::move(rays))) {
        glm::vec3 place(0.0f);
        float radius = least;
        openings.first_ray_.push_back(openings.rays_.size());
        for (const SkyRay& ray : cluster.rays) {
            place += ray.place / static_cast<float>(cluster.rays.size());
            openings.rays_.push_back(ray.direction);
        }
        for (const SkyRay& ray : cluster.rays)
            radius = std::max(radius, kMargin * glm::distance(place, ray.place));
        openings.spheres_.emplace_back(place, radius);
    }
    openings.first_ray_.push_back(openings.rays_.size());
    openings.tracer_ = &tracer;
    openings.set_sky(sky);
    openings.find_visible(pilots, starts, seed, stop);
    return stop && *stop ? SkyOpenings{} : openings;
}

void SkyOpenings::set_sky(const GatherSky& sky) {
    sky_ = &sky;
    brightness_.assign(spheres_.size(), 0.0f);
    for (size_t k = 0; k < spheres_.size(); ++k) {
        const size_t first = first_ray_[k], end = first_ray_[k + 1];
        for (size_t i = first; i < end; ++i)
            brightness_[k] += mean_colour(sky.radiance(rays_[i])) / static_cast<float>(end - first);
    }
}

void SkyOpenings::find_visible(std::span<const GatherPoint> pilots, std::span<const glm::vec3> starts,
                               uint64_t seed, const std::atomic<bool>* stop) {
    visible_.assign(pilots.size() * spheres_.size(), 0.0f);
    for (const GatherPoint& pilot : pilots) pilots_.push_back({pilot.position, pilot.normal});
    parallel_ranges(pilots.size(), kPilotsATask, [&](size_t first, size_t last) {
        for (size_t i = first; i < last && !(stop && *stop); ++i) {
            Random random(seed, pilots.size() + i);
            for (size_t k = 0; k < spheres_.size(); ++k) {
                const Cone cone = cone_of(spheres_[k], pilots[i].position);
                if (!(cone.height > 0) || !(largest_cosine(cone, pilots[i].normal) > 0)) continue;
                const glm::dvec2 shift = random_shift(random);
                for (uint32_t ray = 0; ray < kRaysATest; ++ray) {
                    const glm::vec3 direction = cone.draw(lattice_point(ray, kRaysATest, shift));
                    if (glm::dot(direction, pilots[i].normal) > 0 &&
                        !tracer_->occluded_along(starts[i], direction))
                        visible_[i * spheres_.size() + k] += 1.0f / kRaysATest;
                }
            }
        }
    });
}

void SkyOpenings::add_visible(const GatherPoint& point, std::span<float> visible) const {
    // The nearest pilots; one that faces elsewhere counts as further away.
    std::array<std::pair<float, size_t>, kPilotsAbout> nearest;
    nearest.fill({std::numeric_limits<float>::infinity(), 0});
    for (size_t i = 0; i < pilots_.size(); ++i) {
        const glm::vec3 offset = pilots_[i].position - point.position;
        const float turned = 2 - glm::dot(pilots_[i].normal, point.normal);
        const float distance2 = glm::dot(offset, offset) * turned * turned;
        if (!(distance2 < nearest.back().first)) continue;
        size_t at = nearest.size() - 1;
        for (; at > 0 && distance2 < nearest[at - 1].first; --at) nearest[at] = nearest[at - 1];
        nearest[at] = {distance2, i};
    }
    for (const auto& [distance2, pilot] : nearest)
        if (std::isfinite(distance2))
            for (size_t k = 0; k < visible.size(); ++k)
                visible[k] += visible_[pilot * visible.size() + k] / kPilotsAbout;
}

void SkyOpenings::find_densities(const GatherPoint& point, float rays, std::span<float> densities) const {
    std::vector<float> visible(spheres_.size(), kUnseen);
    add_visible(point, visible);
    float all = 0;
    for (size_t k = 0; k < spheres_.size(); ++k) {
        const Cone cone = cone_of(spheres_[k], point.position);
        densities[k] = cone.height > 0 ? largest_cosine(cone, point.normal) * brightness_[k] * visible[k] : 0;
        all += densities[k] * cone.height;
    }
    if (!(all > 0)) return;
    // The share of a sphere's rays is its part of `all`, and the solid angle of its cone 2 pi times the
    // height.
    for (float& density : densities) density *= rays / (2 * all);
}

void SkyOpenings::each_ray(const GatherPoint& point, std::span<const float> densities, float rays,
                           uint32_t count,
                           const std::function<void(const glm::vec3&, const glm::vec3&)>& visit) const {
    std::vector<Cone> cones;
    std::vector<double> ends;  // of each sphere's part of the rays
    for (size_t k = 0; k < spheres_.size(); ++k) {
        cones.push_back(cone_of(spheres_[k], point.position));
        ends.push_back((ends.empty() ? 0 : ends.back()) + double{densities[k]} * cones[k].height);
    }
    if (ends.empty() || !(ends.back() > 0)) return;
    Random random(point.seed);
    const glm::dvec2 shift = random_shift(random);
    const double first = random.uniform();
    const glm::vec3 start = ray_start(*tracer_, point);
    size_t sphere = 0;
    for (uint32_t i = 0; i < count; ++i) {
        while ((i + first) / count * ends.back() >= ends[sphere] && sphere + 1 < ends.size()) ++sphere;
        const glm::vec3 direction = cones[sphere].draw(lattice_point(i, count, shift));
        const float cosine = glm::dot(direction, point.normal);
        if (!(cosine > 0) || tracer_->occluded_along(start, direction)) continue;
        float sum = cosine;
        for (size_t k = 0; k < cones.size(); ++k)
            if (densities[k] > 0 && (k == sphere || cones[k].holds(direction))) sum += densities[k];
        visit(direction, sky_->radiance(direction) * (cosine * rays / (static_cast<float>(count) * sum)));
    }
}

}  // namespace lucarne::gi
