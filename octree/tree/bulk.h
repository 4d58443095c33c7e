#pragma once

#include <array>

#include <glm/vec3.hpp>

#include "octree/tree/source.h"

namespace lucarne::octree {

/// The box {low, high} to look at: that of the points, or, where a few strays make it far larger than what
/// the rest take (a scanner that saw a bird, a reflection, the next village), the box of the others. Known
/// from the directory, so as exact as nodes are small. The box of all points where a device could not tell
/// the others apart. World units.
std::array<glm::dvec3, 2> bulk_of(const NodeSource& source);

}  // namespace lucarne::octree
