// Small meshes for tests of voxels.
#pragma once

#include <cmath>
#include <utility>

#include <glm/common.hpp>
#include <glm/vec3.hpp>

#include "io/core/random.h"
#include "io/formats/mesh/mesh.h"

namespace lucarne::gi::meshes {

using io::mesh::Mesh;

inline Mesh finished(Mesh mesh) {
    mesh.finish();
    return mesh;
}

/// A box of 12 triangles that turn left seen from outside.
inline Mesh box(const glm::dvec3& low, const glm::dvec3& high) {
    Mesh mesh;
    for (int i = 0; i < 8; ++i)
        mesh.positions.emplace_back(i & 1 ? high.x : low.x, i & 2 ? high.y : low.y, i & 4 ? high.z : low.z);
    for (const auto& [a, b, c, d] : {std::array<uint32_t, 4>{0, 2, 3, 1},
                                     {4, 5, 7, 6},
                                     {0, 1, 5, 4},
                                     {2, 6, 7, 3},
                                     {0, 4, 6, 2},
                                     {1, 3, 7, 5}}) {
        mesh.triangles.push_back({a, b, c});
        mesh.triangles.push_back({a, c, d});
    }
    return mesh;
}

/// A sphere of `rings` rings of triangles, which turn left seen from outside.
inline Mesh sphere(const glm::dvec3& middle, double radius, uint32_t rings) {
    Mesh mesh;
    for (uint32_t j = 0; j <= rings; ++j)
        for (uint32_t i = 0; i < 2 * rings; ++i) {
            const double down = M_PI * j / rings, around = M_PI * i / rings;
            mesh.positions.push_back(middle + radius * glm::dvec3(std::sin(down) * std::cos(around),
                                                                  std::sin(down) * std::sin(around),
                                                                  std::cos(down)));
        }
    for (uint32_t j = 0; j < rings; ++j)
        for (uint32_t i = 0; i < 2 * rings; ++i) {
            const uint32_t a = j * 2 * rings + i, b = j * 2 * rings + (i + 1) % (2 * rings);
            mesh.triangles.push_back({a, a + 2 * rings, b + 2 * rings});
            mesh.triangles.push_back({a, b + 2 * rings, b});
        }
    return mesh;
}

/// Triangles of any size and direction in a cube of side 1.
inline Mesh soup(uint32_t triangles, uint64_t seed) {
    Random random(seed);
    Mesh mesh;
    for (uint32_t i = 0; i < 3 * triangles; ++i)
        mesh.positions.emplace_back(random.uniform(), random.uniform(), random.uniform());
    for (uint32_t i = 0; i < triangles; ++i) mesh.triangles.push_back({3 * i, 3 * i + 1, 3 * i + 2});
    return mesh;
}

}  // namespace lucarne::gi::meshes
