#pragma once

#include <vector>

#include "octree/convert/chunks/record_loader.h"
#include "octree/convert/nodes/emitter.h"

namespace lucarne::octree {

/// The result of building a chunk: every node below its root is settled; the root waits for its parent.
struct Subtree {
    std::vector<std::byte> payload;
    std::vector<format::Entry> entries;  ///< depth first; payload offsets from the start of `payload`
    Pending root;
    std::vector<std::byte> sample;  ///< the root's sample, whole records in Morton order
    double encode_seconds = 0;      ///< CPU time
};

/// Builds chunk number `index` in memory.
Result<Subtree> build_subtree(const RecordLoader& loader, size_t index, const NodeLimits& limits);

/// Returns the surface in a cube: the sum of its points' areas, where unknown ones count as the mean of the
/// known. If none is known, the surface is estimated from the cells that the points (sorted `codes`) occupy.
/// A surface of area A crosses about 1.5 A / c^2 cells of size c (Crofton: the mean of |nx|+|ny|+|nz|). The
/// finest cells that still hold four points or more are counted. Each node that divides the points of one
/// place gets its part of the cell.
double surface_of(std::span<const float> areas, std::span<const uint64_t> codes, uint32_t level,
                  double root_size);

}  // namespace lucarne::octree
