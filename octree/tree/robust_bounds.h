#pragma once

#include <array>

#include <glm/vec3.hpp>

#include "octree/tree/source.h"

namespace lucarne::octree {

/// Returns the robust bounds {low, high} of a cloud, the box that a view should show. These are the bounds of
/// the points or, where a few outliers make those far larger (a scanner that saw a bird, a reflection, the
/// next village), the bounds of the others. The box comes from the directory and a sample of the coarse
/// leaves, so it is as exact as nodes are small. It is the box of all points where a device could not tell
/// the others apart. World units.
std::array<glm::dvec3, 2> robust_bounds(const NodeSource& source);

}  // namespace lucarne::octree
