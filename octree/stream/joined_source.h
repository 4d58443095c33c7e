#pragma once

#include <memory>
#include <vector>

#include "octree/tree/source.h"

namespace lucarne::octree {

/// Joins sources (hundreds of scans, say) into one with many roots, under one cut and one budget. They keep
/// their root cubes, schemas and units. The joined unit is theirs where they agree, else the metre; scans are
/// numbered through. Where parts overlap, all of their points are there. One source comes back as it is.
/// Errors (ErrorKind::input_rejected): more nodes together than a directory can number; none at all.
Result<std::shared_ptr<const NodeSource>> join_sources(
    std::vector<std::shared_ptr<const NodeSource>> sources);

}  // namespace lucarne::octree
