#pragma once

#include <vector>

#include "octree/convert/build.h"
#include "octree/convert/chunks/chunk_plan.h"
#include "octree/convert/scans/unify.h"

namespace lucarne::octree {

/// Divides what another number of ranks, or ranks on other machines, have left of the same build among these,
/// as if they had finished the same stages: their workspaces get the records and scratch files. Whatever is
/// `left` is removed. A meeting. If a part is damaged, nothing is taken over, and a warning says so. Errors:
/// a part is on no machine that takes part; those of writing. Then all parts stay.
Result<void> take_over(Workspace& work, std::vector<Workspace>& left, Ranks& ranks, const Unifier& inputs,
                       const BuildOptions& options, const MemoryPlan& memory);

}  // namespace lucarne::octree
