#pragma once

#include <cstdint>
#include <optional>
#include <span>
#include <vector>

#include <glm/vec3.hpp>

#include "octree/tree/key.h"

namespace lucarne::octree {

/// A point's normal and share of the surface, as good as a sample shows them.
struct QuickSurface {
    glm::vec3 normal{0.0f};  ///< unit; zero where there is no plane or nothing says which way it faces
    float area = 0;          ///< in faces of the root cube; kStrayArea: hangs in the air
};

/// Of every point from its nearest neighbours among the points near it along two Morton curves, one of them
/// shifted (after Chan, "Approximate nearest neighbor queries revisited", 1998): no tree is built, and some
/// neighbours are missed. The plane is their least-squares plane; the share is pi r^2 / k, which for points
/// strewn at random is right on average whatever k is. `station(i)` is where point i was seen from: its
/// normal faces there.
std::vector<QuickSurface> quick_surface(std::span<const glm::dvec3> points, const Cube& root,
                                        std::span<const std::optional<glm::dvec3>> stations);

}  // namespace lucarne::octree
