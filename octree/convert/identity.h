#pragma once

#include <string>

#include "octree/cluster/ranks.h"
#include "octree/convert/build.h"
#include "octree/convert/scans/scan_stage.h"

namespace lucarne::octree {

/// Returns what a build's result depends on, as lines of text: options, and for each input its path, size,
/// time of the last change, the checksum of its beginning, and what its header says. Each rank looks into its
/// `own` inputs, and all return the same. A meeting.
Result<std::string> build_identity(const BuildOptions& options, InputRange own, Ranks& ranks);

}  // namespace lucarne::octree
