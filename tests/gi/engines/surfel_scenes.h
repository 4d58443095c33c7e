// Analytic scenes of surfels, built by hand: no scan, no octree, no sampling noise.
#pragma once

#include <cmath>
#include <cstdint>
#include <vector>

#include <glm/geometric.hpp>
#include <glm/vec3.hpp>

#include "gi/shared/surfel.h"

namespace lucarne::gi {

inline const glm::vec3 kX(1, 0, 0), kY(0, 1, 0), kZ(0, 0, 1), kO(0.0f);

namespace scenes {

/// A square lattice is closed from a coverage (disc area over surface area) of pi/2; 1.7 leaves a margin.
inline constexpr float kLatticeCoverage = 1.7f;

/// Appends the parallelogram corner + u a + v b, a and b in [0, 1], as n x n surfels whose areas add up to
/// its area.
inline void add_rectangle(std::vector<Surfel>& surfels, const glm::vec3& corner, const glm::vec3& u,
                          const glm::vec3& v, int n, const glm::vec3& albedo, uint32_t material = 0) {
    const glm::vec3 normal = glm::normalize(glm::cross(u, v));
    const float area = glm::length(glm::cross(u, v)) / static_cast<float>(n * n);
    const float radius = std::sqrt(kLatticeCoverage * area / 3.14159265f);
    for (int y = 0; y < n; ++y)
        for (int x = 0; x < n; ++x) {
            const float a = (static_cast<float>(x) + .5f) / static_cast<float>(n);
            const float b = (static_cast<float>(y) + .5f) / static_cast<float>(n);
            surfels.push_back({corner + u * a + v * b, normal, albedo, radius, area, material});
        }
}

/// The six faces of the cube [0, size]^3, normals inward.
inline std::vector<Surfel> closed_box(float size, int n, const glm::vec3& albedo, uint32_t material = 0) {
    std::vector<Surfel> surfels;
    const glm::vec3 x(size, 0, 0), y(0, size, 0), z(0, 0, size), o(0.0f);
    add_rectangle(surfels, o, x, y, n, albedo, material);
    add_rectangle(surfels, z, y, x, n, albedo, material);
    add_rectangle(surfels, o, y, z, n, albedo, material);
    add_rectangle(surfels, x, z, y, n, albedo, material);
    add_rectangle(surfels, o, z, x, n, albedo, material);
    add_rectangle(surfels, y, x, z, n, albedo, material);
    return surfels;
}

}  // namespace scenes
}  // namespace lucarne::gi
