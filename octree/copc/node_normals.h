#pragma once

#include <vector>

#include <glm/vec3.hpp>

#include "io/core/error.h"

namespace lucarne::octree {

/// Estimates the normals of points from their nearest neighbours among them: unit vectors, or zero where
/// there is no stable plane (octree/normals/surface/surface_sample.h). Their sign is not known; they point
/// upward. Surfaces are lit on both sides.
Result<std::vector<glm::vec3>> unsigned_normals(std::vector<glm::dvec3> points);

}  // namespace lucarne::octree
