#pragma once

#include <cstdint>
#include <span>
#include <vector>

#include <glm/vec3.hpp>

#include "gi/shared/flat_surfel.h"
#include "gi/volume/voxels.h"

namespace lucarne::gi::volume {

/// What light passes in occupied voxels, by voxel.
struct Openings {
    /// The blocks that stop lines of sight.
    std::vector<uint64_t> blocks;
    /// The shares of light along the three axes that pass a voxel: those of its columns of blocks that are
    /// free from side to side. 0 if a wall may be in it.
    std::vector<glm::vec3> passing;
};

/// Finds openings: voxels about which all air is connected through free blocks, and so are the openings
/// beside them. No wall is in these, so nothing leaks if their blocks are as thin as the discs in them: only
/// those stay closed of which a disc covers the middle, where it is a wall's, or that lead to other air.
/// Elsewhere blocks are those that discs touch, and gaps between discs. `surfels`: of the voxels. The result
/// is the same whatever the number of threads.
Openings find_openings(const Voxels& voxels, std::span<const FlatSurfel> surfels);

}  // namespace lucarne::gi::volume
