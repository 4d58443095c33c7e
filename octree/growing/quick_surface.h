#pragma once

#include <cstdint>
#include <optional>
#include <span>
#include <vector>

#include <glm/vec3.hpp>

#include "octree/tree/key.h"

namespace lucarne::octree {

/// A point's normal and share of the surface, as accurate as a sample allows.
struct QuickSurface {
    glm::vec3 normal{0.0f};  ///< unit; zero where there is no plane or its side is unknown
    float area = 0;          ///< in faces of the root cube; kStrayArea: an outlier
};

/// Estimates the surface at every point from its nearest neighbours among the points near it along two Morton
/// curves, one of them shifted (after Chan, "Approximate nearest neighbor queries revisited", 1998). No tree
/// is built, and some neighbours are missed. The normal is that of the neighbours' least-squares plane. The
/// share is pi r^2 / k, which for random points is right on average whatever k is. `stations[i]` is the
/// position from which point i was seen: its normal faces there.
std::vector<QuickSurface> quick_surface(std::span<const glm::dvec3> points, const Cube& root,
                                        std::span<const std::optional<glm::dvec3>> stations);

}  // namespace lucarne::octree
