#pragma once

#include <memory>
#include <span>
#include <vector>

#include <glm/vec3.hpp>

#include "gi/volume/air.h"
#include "gi/volume/faces.h"
#include "gi/volume/voxels.h"

namespace lucarne::gi::volume {

/// The voxels of a scene, as all stages read them.
struct Space {
    Voxels voxels;
    Faces faces;
    Air air;

    const Grid& grid() const { return voxels.grid(); }
    /// The cell of air in front of a face. It may lie just outside the grid.
    glm::ivec3 cell_before(const Face& face) const {
        return grid().cell(voxels.occupied()[face.voxel]) + step_of(face.side);
    }
};

/// A space and the light at its faces.
struct LitLevel {
    std::shared_ptr<const Space> space;
    std::vector<glm::vec3> irradiance;  ///< by face, W/m^2
};

/// Returns the means of values of faces over each face and those beside it that belong to the same surface:
/// what few lines of sight or directions leave uneven becomes smooth, and an even value stays as it is.
std::vector<glm::vec3> smoothed(const Space& space, std::span<const glm::vec3> values);

}  // namespace lucarne::gi::volume
