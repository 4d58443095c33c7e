#include "gi/engines/paths/cosine_rays.h"

#include <algorithm>
#include <cmath>
#include <limits>

#include <glm/common.hpp>
#include <glm/geometric.hpp>

#include "gi/lighting/area_points.h"
#include "gi/shared/brdf.h"
#include "gi/tracing/light_sampling.h"
#include "io/core/random.h"

namespace lucarne::gi::paths {
namespace {

/// Rays along the surface would have cross sections without end.
constexpr float kLeastCosine = 0.1f;

/// Returns the width of a ray's cross section a metre from its start, m.
float width_of(const RayStart& start, const glm::vec3& direction, uint32_t count) {
    const float cosine = std::max(glm::dot(direction, start.normal), kLeastCosine);
    return std::sqrt(kPi / (static_cast<float>(count) * cosine));
}

glm::vec3 direction_in(const glm::vec3& normal, const glm::vec3& tangent, const glm::vec3& bitangent,
                       const glm::dvec2& square) {
    const glm::dvec2 disc = on_disc(2.0 * square - 1.0);
    const double height = std::sqrt(std::max(0.0, 1 - glm::dot(disc, disc)));
    return glm::normalize(tangent * static_cast<float>(disc.x) + bitangent * static_cast<float>(disc.y) +
                          normal * static_cast<float>(height));
}

/// Returns by how much the even points of (seed, stream) are shifted.
glm::dvec2 shift_of(uint64_t seed, uint64_t stream) {
    Random random(seed, stream);
    glm::dvec2 shift;
    shift.x = random.uniform();
    shift.y = random.uniform();
    return shift;
}
glm::dvec2 shifted(const glm::dvec2& shift, uint32_t i) {
    return glm::fract(shift + static_cast<double>(i) * kR2);
}

}  // namespace

RayStart start_at(const SideSurfels& surfels, Side side) {
    const Surfel s = surfels[side / 2];
    return {s.position, side % 2 ? -s.normal : s.normal, s.radius};
}

glm::vec3 cosine_direction(const glm::vec3& normal, const glm::dvec2& square) {
    glm::vec3 tangent, bitangent;
    tracing::frame_of(normal, tangent, bitangent);
    return direction_in(normal, tangent, bitangent, square);
}

glm::dvec2 even_point(uint32_t i, uint64_t seed, uint64_t stream) {
    return shifted(shift_of(seed, stream), i);
}

CosineDirections::CosineDirections(const glm::vec3& normal, uint64_t seed, uint64_t stream)
    : normal_(normal), shift_(shift_of(seed, stream)) {
    tracing::frame_of(normal_, tangent_, bitangent_);
}

glm::vec3 CosineDirections::operator[](uint32_t i) const {
    return direction_in(normal_, tangent_, bitangent_, shifted(shift_, i));
}

RayHit follow(const Surfaces& surfaces, const RayStart& start, const glm::vec3& direction, uint32_t count,
              float& distance) {
    const glm::vec3 origin = tracing::offset_origin(start.position, start.normal, start.radius);
    const auto hit = surfaces.tracer().first_hit(origin, direction);
    distance = hit ? hit->distance : std::numeric_limits<float>::infinity();
    if (!hit) return {};
    return {surfaces.side_of(*hit, origin + direction * hit->distance),
            distance * width_of(start, direction, count)};
}

glm::vec3 place_of(const RayStart& start, uint64_t seed, uint64_t stream, uint32_t i, uint32_t count,
                   const RayHit& hit) {
    const glm::vec3 direction = cosine_direction(start.normal, even_point(i, seed, stream));
    return tracing::offset_origin(start.position, start.normal, start.radius) +
           direction * (hit.width / width_of(start, direction, count));
}

float trace_rays(const Surfaces& surfaces, const RayStart& start, uint64_t seed, uint64_t stream,
                 std::span<RayHit> hits) {
    const auto count = static_cast<uint32_t>(hits.size());
    const CosineDirections directions(start.normal, seed, stream);
    double nearness = 0;
    for (uint32_t i = 0; i < count; ++i) {
        float distance = 0;
        hits[i] = follow(surfaces, start, directions[i], count, distance);
        nearness += 1 / std::max<double>(distance, 1e-6);
    }
    return static_cast<float>(count / std::max(nearness, 1e-12));
}

bool are_shorter(const Surfaces& surfaces, const RayStart& start, uint64_t seed, uint64_t stream,
                 uint32_t count, float length) {
    const glm::vec3 origin = tracing::offset_origin(start.position, start.normal, start.radius);
    const CosineDirections directions(start.normal, seed, stream);
    double nearness = 0;
    for (uint32_t i = 0; i < count && !(nearness * length > count); ++i) {
        const auto hit = surfaces.tracer().first_hit(origin, directions[i]);
        if (hit) nearness += 1 / std::max<double>(hit->distance, 1e-6);
    }
    return nearness * length > count;
}

}  // namespace lucarne::gi::paths
