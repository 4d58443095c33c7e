#pragma once

#include <memory>
#include <vector>

#include "octree/tree/source.h"

namespace lucarne::octree {

/// Joins sources (hundreds of scans, for example) into one with many roots, for one cut and one budget. They
/// keep their root cubes, schemas and units. The joined unit is theirs if they agree, else the metre. Scans
/// are numbered consecutively. Where parts overlap, all of their points are kept. A single source is returned
/// unchanged. Errors (ErrorKind::input_rejected): no source; more nodes together than a directory can number.
Result<std::shared_ptr<const NodeSource>> join_sources(
    std::vector<std::shared_ptr<const NodeSource>> sources);

}  // namespace lucarne::octree
