#pragma once

#include <array>
#include <cstddef>
#include <cstdint>

#include <glm/vec3.hpp>

#include "gi/volume/native/discs.h"

namespace lucarne::gi::volume {

/// Returns the share of a disc on one side of a line. `distance`: of the line from the disc's middle, in
/// radii; below zero if the middle is on the other side.
float disc_share(float distance);

/// Returns the share of a disc on one side of two lines at once. `cosine`: of the angle between the
/// directions from that side to the lines.
float disc_share(float first, float second, float cosine);

/// The part of a disc in a voxel.
struct DiscPart {
    glm::ivec3 cell{0};
    float share = 0;   ///< of the disc
    uint64_t box = 0;  ///< blocks of the voxel, in a box about the part
};

/// Finds the parts of a disc in the voxels that it touches, if borders of voxels cut it along at most two
/// axes, and once along each. Returns their number, or 0 if there are more. The disc must lie in the grid as
/// a whole.
size_t few_parts(const DiscBatch& discs, size_t disc, std::array<DiscPart, 4>& parts);

}  // namespace lucarne::gi::volume
