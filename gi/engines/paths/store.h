// The sections of the bake file.
#pragma once

#include "gi/bake/precomputation.h"
#include "gi/engines/paths/bake.h"
#include "gi/engines/paths/gathering_points.h"

namespace lucarne::gi::paths {

/// Write and read a finished result. Reading checks every index, so that nothing that uses it has to.
/// Errors: a section is missing or damaged.
BakeSections write_paths(const LightPaths& paths);
Result<LightPaths> read_paths(const BakeSections& sections, uint32_t rays_a_point);

/// Write and read the gathering points of an unfinished one. PointChooser::restore() checks them.
BakeSections write_points(const PointChooser::State& state);
Result<PointChooser::State> read_points(const BakeSections& sections);

}  // namespace lucarne::gi::paths
