#pragma once

#include <array>
#include <cstddef>

#include <glm/vec3.hpp>

namespace lucarne::gi::volume {

/// Returns the share of a disc on one side of a line. `distance`: of the line from the disc's middle, in
/// radii; below zero if the middle is on the other side.
float disc_share(float distance);

/// Returns the share of a disc on one side of two lines at once. `cosine`: of the angle between the
/// directions from that side to the lines.
float disc_share(float first, float second, float cosine);

/// The part of a disc in a voxel. Lengths are in voxels.
struct DiscPart {
    glm::ivec3 cell{0};
    float share = 0;                  ///< of the disc
    glm::vec3 low{0.0f}, high{0.0f};  ///< of a box that holds the part
};

/// Finds the parts of a disc in the voxels that it touches, if borders of voxels cut it along at most two
/// axes, and once along each. Returns their number, or 0 if there are more. `place`, `radius`: of the disc,
/// in voxels; the disc must lie where coordinates are positive.
size_t few_parts(const glm::vec3& place, const glm::vec3& normal, float radius,
                 std::array<DiscPart, 4>& parts);

}  // namespace lucarne::gi::volume
