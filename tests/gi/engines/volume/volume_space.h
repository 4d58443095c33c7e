// Voxels of surfels that are made by hand, for tests of the stages of the volume engine.
#pragma once

#include <vector>

#include <gtest/gtest.h>

#include "gi/engines/volume/space.h"
#include "gi/shared/brdf.h"
#include "tests/gi/engines/surfel_scenes.h"
#include "tests/gi/tree/flat_scenes.h"

namespace lucarne::gi::volume {

/// The voxels of some surfels in a grid.
inline Space make_space(const std::vector<FlatSurfel>& surfels, const Grid& grid) {
    Space space;
    auto voxels = Voxels::divide(surfels, grid);
    EXPECT_TRUE(voxels);
    if (!voxels) return space;
    space.voxels = std::move(*voxels);
    space.faces = Faces::find(space.voxels, surfels);
    space.air = Air(space.voxels, surfels);
    return space;
}

/// The same in a grid about all of them. The unit cube and what is in it have voxels of 1/29 m.
inline Space make_space(const std::vector<FlatSurfel>& surfels, uint32_t longest = 32) {
    return make_space(surfels, grid_about(surfels, longest));
}

/// The unit cube, seen from inside.
inline std::vector<FlatSurfel> unit_cube() {
    return flat::of(scenes::closed_box(1, 60, glm::vec3(0.5f)));
}

/// Whether a face looks into the unit cube.
inline bool looks_inside(const Face& face) {
    return glm::dot(face.normal, glm::vec3(0.5f) - face.position) > 0;
}

/// Radiance 1 of the faces for which lit(face) is true, and 0 of the others.
template <class Lit>
std::vector<glm::vec3> radiance_of(const Space& space, const Lit& lit) {
    std::vector<glm::vec3> radiance;
    for (const Face& face : space.faces.all()) radiance.emplace_back(lit(face) ? 1.0f : 0.0f);
    return radiance;
}

/// The mean over the areas of those faces for which counts(face) is true, divided by pi: of irradiance, the
/// form factor.
template <class Counts>
double mean_share(const Space& space, std::span<const glm::vec3> irradiance, const Counts& counts) {
    double sum = 0, areas = 0;
    for (size_t i = 0; i < irradiance.size(); ++i) {
        const Face& face = space.faces.all()[i];
        if (!counts(face)) continue;
        sum += face.area * irradiance[i].x;
        areas += face.area;
    }
    EXPECT_GT(areas, 0);
    return sum / areas / kPi;
}

/// Faces that look into the unit cube from one of its walls.
inline auto wall(int side) {
    return [side](const Face& face) { return face.side == side && looks_inside(face); };
}

}  // namespace lucarne::gi::volume
