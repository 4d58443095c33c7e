// Flat surfels for tests of trees and gathers.
#pragma once

#include <cmath>
#include <cstring>
#include <vector>

#include <glm/geometric.hpp>

#include "gi/shared/flat_surfel.h"
#include "gi/shared/surfel_code.h"
#include "io/core/parallel.h"
#include "io/core/random.h"
#include "tests/gi/engines/surfel_scenes.h"

namespace lucarne::gi::flat {

inline FlatSurfel of(const Surfel& s) {
    return {s.position.x,
            s.position.y,
            s.position.z,
            s.radius,
            s.area,
            encode_octahedral(s.normal),
            encode_albedo(s.albedo) | kSurfelHasNormal,
            s.material,
            0};
}
inline std::vector<FlatSurfel> of(const std::vector<Surfel>& surfels) {
    std::vector<FlatSurfel> result;
    for (const Surfel& s : surfels) result.push_back(of(s));
    return result;
}

/// A square in the plane z = 0 of n x n surfels.
inline std::vector<FlatSurfel> square(int n, float size) {
    std::vector<Surfel> surfels;
    scenes::add_rectangle(surfels, kO, size * kX, size * kY, n, glm::vec3(0.5f));
    return of(surfels);
}

/// Surfels of a cube's walls at random places, with noise in positions and normals.
inline std::vector<FlatSurfel> noisy_room(size_t count) {
    std::vector<FlatSurfel> surfels;
    Random random(3);
    const auto uniform = [&] { return static_cast<float>(random.uniform()); };
    const float area = 6 / static_cast<float>(count), radius = std::sqrt(1.7f * area / 3.14159265f);
    for (size_t i = 0; i < count; ++i) {
        glm::vec3 p(uniform(), uniform(), 0), n(0, 0, 1);
        if (i & 1) p.z = 1 - p.z, n = -n;
        p.z += 0.2f * radius * (uniform() - 0.5f);
        n += 0.2f * (glm::vec3(uniform(), uniform(), uniform()) - 0.5f);
        for (size_t turns = i % 3; turns > 0; --turns) p = {p.y, p.z, p.x}, n = {n.y, n.z, n.x};
        surfels.push_back(of(Surfel{p, glm::normalize(n), glm::vec3(0.5f), radius, area, 0}));
    }
    return surfels;
}

}  // namespace lucarne::gi::flat
