#pragma once

#include <vector>

#include <glm/vec3.hpp>

#include "io/core/error.h"

namespace lucarne::octree {

/// The normals of points from their nearest neighbours among them: unit, or zero where there is no stable
/// plane (octree/normals/surface/surface_sample.h). Unsigned, that is turned upward: surfaces are lit on both
/// sides.
Result<std::vector<glm::vec3>> unsigned_normals(std::vector<glm::dvec3> points);

}  // namespace lucarne::octree
