#pragma once

#include <vector>

#include "octree/convert/chunks/record_loader.h"
#include "octree/convert/nodes/emitter.h"

namespace lucarne::octree {

/// A chunk built: every node under its root is settled; the root waits for its parent.
struct Subtree {
    std::vector<std::byte> payload;
    std::vector<format::Entry> entries;  ///< depth first, payload offsets from the start of `payload`
    Pending root;
    std::vector<std::byte> sample;  ///< the root's sample, whole records in Morton order
    double encode_seconds = 0;      ///< CPU time
};

/// Builds chunk number `index` in memory.
Result<Subtree> build_subtree(const RecordLoader& loader, size_t index, const NodeLimits& limits);

/// The surface in a cube: the sum of its points' shares, those unknown counted as the mean of the known.
/// Where none is known it is estimated from the cells that the points (sorted `codes`) occupy: a surface of
/// area A crosses about 1.5 A / c^2 cells of size c (Crofton: the mean of |nx|+|ny|+|nz|), seen where cells
/// hold four points or more. Of the nodes that divide one place's points, each has its part of the cell.
double surface_of(std::span<const float> areas, std::span<const uint64_t> codes, uint32_t level,
                  double root_size);

}  // namespace lucarne::octree
