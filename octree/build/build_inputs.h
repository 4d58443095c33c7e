#pragma once

#include <optional>

#include "octree/build/build.h"
#include "octree/build/scan_stage.h"

namespace lucarne::octree {

/// Which normals to estimate: empty for no estimation at all, else whether normals are wanted besides areas.
Result<std::optional<bool>> wanted_normals(NormalsMode mode, const Unifier& inputs);

/// Errors: the inputs are in different units of length.
Result<void> check_units(const Unifier& inputs);

/// Of a cache of these inputs with records of `schema`.
SourceHeader header_of(const Unifier& inputs, const ScanFacts& facts, const io::Schema& schema);

}  // namespace lucarne::octree
