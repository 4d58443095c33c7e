#pragma once

#include <vector>

#include <glm/geometric.hpp>
#include <glm/vec2.hpp>
#include <glm/vec3.hpp>

#include "octree/holes/voxels.h"

namespace lucarne::octree {

/// A plane of the scan: the smooth patches that lie in it, which need not be connected.
struct HolePlane {
    glm::vec3 normal{0.0f}, centre{0.0f};
    glm::vec3 u{0.0f}, v{0.0f};         ///< unit axes in the plane
    glm::vec3 low{0.0f}, high{0.0f};    ///< box of its voxels
    glm::vec2 least{0.0f}, most{0.0f};  ///< the same in the plane's axes
    size_t voxels = 0;
    std::vector<uint32_t> bend;  ///< voxels beside them at which the surface bends away smoothly (bends.h)

    glm::vec2 flat(const glm::vec3& p) const { return {glm::dot(p - centre, u), glm::dot(p - centre, v)}; }
    float height(const glm::vec3& p) const { return glm::dot(p - centre, normal); }
};

/// Finds the largest planes, at most `most`, and marks their voxels (Voxel::plane). Patches grow over
/// neighbouring voxels whose normals agree with the patch's; patches in one plane are joined. The larger
/// planes come first.
std::vector<HolePlane> find_planes(Voxels& voxels, size_t most);

}  // namespace lucarne::octree
