#pragma once

#include <cstdint>
#include <span>

#include <glm/vec3.hpp>

#include "octree/normals/orientation/signed_forest.h"

namespace lucarne::octree {

/// A disc that stands for some points of a surface.
struct SightDisc {
    glm::dvec3 position{0.0};
    glm::vec3 normal{0.0f};
    float area = 0;  ///< share of the surface of all these points
    uint32_t component = 0;
    uint32_t unused = 0;  ///< in place of padding, which messages would include
};

/// Adds votes on components that see each other across the air: both border on the same air, which a scanner
/// looked into or not, so they both face each other or both face away. Rays go from some of the discs to both
/// of their sides, and vote for what they hit first. The components of the discs are the nodes of `votes`.
/// Time and memory depend on the number of discs only. `points_each`: the number of points for which a disc
/// stands.
void vote_by_sight(std::span<const SightDisc> discs, size_t points_each, SignVotes& votes);

}  // namespace lucarne::octree
