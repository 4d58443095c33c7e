#pragma once

#include <string>
#include <vector>

#include <glm/vec3.hpp>

#include "io/synthetic/patch_mesh.h"

namespace lucarne::io {

/// An analytic scene: its surfaces, and the places where a surveyor would stand.
struct SceneModel {
    PatchMesh mesh;
    std::vector<glm::dvec3> stations;
    /// Box in which further stations may stand, if nothing is nearer than 0.4 m.
    glm::dvec3 walk_min{0.0}, walk_max{0.0};
};

/// One builder per scene; sizes in metres, z up.
SceneModel build_cornell();
SceneModel build_furnace();
SceneModel build_nave();
SceneModel build_two_rooms();
SceneModel build_house();
SceneModel build_loft();
SceneModel build_lattice();
SceneModel build_arbour();
SceneModel build_statue();
SceneModel build_ring();
SceneModel build_paraboloid();
SceneModel build_primitives();

}  // namespace lucarne::io
