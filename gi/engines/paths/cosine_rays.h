#pragma once

#include <cstdint>
#include <span>

#include <glm/vec2.hpp>
#include <glm/vec3.hpp>

#include "gi/engines/paths/sides.h"
#include "gi/engines/paths/surfaces.h"

namespace lucarne::gi::paths {

/// Where a ray starts: on a side, lifted by a radius.
struct RayStart {
    glm::vec3 position{0.0f}, normal{0.0f, 0.0f, 1.0f};
    float radius = 0;
};
RayStart start_at(const SideSurfels& surfels, Side side);

/// What a ray meets.
struct RayHit {
    Side side = kNone;  ///< kNone: it leaves the scene
    float width = 0;    ///< edge of a square as large as the ray's cross section there, m
};

/// Returns the direction of the hemisphere about a unit normal that belongs to a point of the unit square:
/// even points give directions whose density is cos / pi (Malley's method over the concentric map of
/// Shirley & Chiu 1997).
glm::vec3 cosine_direction(const glm::vec3& normal, const glm::dvec2& square);

/// Returns point `i` of `count` that are even in the unit square, in any order, shifted by (seed, stream).
glm::dvec2 even_point(uint32_t i, uint64_t seed, uint64_t stream);

/// Directions of a hemisphere that are even by the cosine: cosine_direction() of even_point(), with what all
/// have in common.
class CosineDirections {
 public:
    CosineDirections(const glm::vec3& normal, uint64_t seed, uint64_t stream);
    glm::vec3 operator[](uint32_t i) const;

 private:
    glm::vec3 normal_, tangent_{0.0f}, bitangent_{0.0f};
    glm::dvec2 shift_;
};

/// Follows one of `count` rays of a point. Their directions have the density cos / pi, so each stands for a
/// solid angle of pi / (count cos); the width of its cross section is the root of that times the distance
/// (Igehy 1999, "Tracing ray differentials", for rays from one point). Sets `distance`, m; infinite if it
/// hits nothing.
RayHit follow(const Surfaces& surfaces, const RayStart& start, const glm::vec3& direction, uint32_t count,
              float& distance);

/// Returns the place that ray `i` of trace_rays() with these arguments met, by its width.
glm::vec3 place_of(const RayStart& start, uint64_t seed, uint64_t stream, uint32_t i, uint32_t count,
                   const RayHit& hit);

/// Traces hits.size() even rays of a point and returns the harmonic mean of their lengths, m; rays that hit
/// nothing count as infinitely long.
float trace_rays(const Surfaces& surfaces, const RayStart& start, uint64_t seed, uint64_t stream,
                 std::span<RayHit> hits);

/// Returns whether the harmonic mean length of so many even rays of a point is below `length`, m. Traces no
/// more of them than it takes to know.
bool are_shorter(const Surfaces& surfaces, const RayStart& start, uint64_t seed, uint64_t stream,
                 uint32_t count, float length);

}  // namespace lucarne::gi::paths
