#pragma once

#include <cstdint>

#include "octree/tree/source.h"

namespace lucarne::octree {

class CacheWriter;

/// Looks for holes in a cache that is about to be finished, on an even sample of its points, and appends the
/// surfels that fill them (octree/FORMAT.md). There are at most kMostFilled, and at most a sixteenth of the
/// points. `header` is the one that the cache will have, with its stations' colours; `memory`: bytes that may
/// be used.
Result<FillingSection> fill_holes(CacheWriter& writer, const SourceHeader& header, uint64_t memory);

}  // namespace lucarne::octree
