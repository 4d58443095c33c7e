#pragma once

#include <glm/vec3.hpp>

#include "gi/shared/surfel.h"

namespace lucarne::gi {

/// Stores the line at which a surfel's disc ends (gi/shared/edge.h). `toward`: unit, from the surfel to the
/// line, in its tangent plane; `distance` in sides of the surfel's cube. The surfel must be complete. It gets
/// no line if it has no normal, if its area is unknown, or if the line is farther away than the code reaches.
void pack_edge(const glm::vec3& toward, float distance, PackedSurfel& surfel);

}  // namespace lucarne::gi
