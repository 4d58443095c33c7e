#pragma once

#include <cstdint>
#include <optional>

#include "octree/tree/source.h"

namespace lucarne::octree {

class CacheWriter;

/// What the search for holes found.
struct HoleSurvey {
    FillingSection filling;
    /// The scan's only station, which saw all of it, if it was not known.
    std::optional<EstimatedStation> station;
};

/// Looks for holes in a cache that is about to be finished, on an even sample of its points, and appends the
/// surfels that fill them (octree/FORMAT.md). There are at most kMostFilled, and at most a sixteenth of the
/// points. `header` is the one that the cache will have, with its stations' colours; `memory`: bytes that may
/// be used.
Result<HoleSurvey> fill_holes(CacheWriter& writer, const SourceHeader& header, uint64_t memory);

}  // namespace lucarne::octree
