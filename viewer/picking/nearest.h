#pragma once

#include <optional>

#include "viewer/picking/exact_point.h"
#include "viewer/picking/node_cache.h"

namespace lucarne::viewer {

/// The point of the scan nearest to a place, within `radius` (world units; infinite for any), by reading only
/// nodes whose cube may hold a nearer one. Equally near: the first in the directory. Empty: none so near.
/// Errors: a node that cannot be read.
Result<std::optional<ExactPoint>> nearest_point(NodeCache& cache, const glm::dvec3& place, double radius);

}  // namespace lucarne::viewer
