#pragma once

#include "octree/cluster/ranks.h"
#include "viewer/commands/options/arguments.h"

namespace lucarne::viewer {

/// Declares `lucarne convert`. `ranks`: the processes that convert together, null for this one alone.
void add_convert_of(CommandLine& line, octree::Ranks* ranks);

}  // namespace lucarne::viewer
