#pragma once

#include <optional>

#include "viewer/picking/exact_point.h"
#include "viewer/picking/node_cache.h"

namespace lucarne::viewer {

/// Returns the point of the scan nearest to a place, within `radius` (world units; may be infinite). Reads
/// only nodes whose cube may contain a nearer point. Of equally near points, returns the first in the
/// directory. Returns nothing if no point is within `radius`. Errors: a node cannot be read.
Result<std::optional<ExactPoint>> nearest_point(NodeCache& cache, const glm::dvec3& place, double radius);

}  // namespace lucarne::viewer
