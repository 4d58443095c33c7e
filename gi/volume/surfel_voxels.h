#pragma once

#include <cstdint>
#include <span>

#include "gi/shared/surfel.h"
#include "gi/volume/voxel_set.h"
#include "io/core/error.h"

namespace lucarne::gi::volume {

/// Divides surfels among the voxels of a grid about them, with `longest` voxels along its longest side. Every
/// voxel that a disc touches is occupied and has its part of the surfel's area (voxels.h); so walls are
/// closed and up to two voxels thick. `origin`: of the surfels' coordinates, m. Errors: no surfel has a disc;
/// discs that together touch too many voxels.
Result<VoxelSet> voxels_of_surfels(std::span<const Surfel> surfels, uint32_t longest,
                                   const glm::dvec3& origin);
/// The same in a given grid.
Result<VoxelSet> voxels_of_surfels(std::span<const Surfel> surfels, const Grid& grid,
                                   const glm::dvec3& origin);

}  // namespace lucarne::gi::volume
