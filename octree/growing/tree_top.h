#pragma once

#include <cstdint>
#include <memory>
#include <optional>
#include <span>
#include <vector>

#include "io/files/file.h"
#include "octree/cache/format.h"
#include "octree/convert/sampling/node_sampler.h"
#include "octree/tree/source.h"

namespace lucarne::octree {

/// Points that are not in a finished node yet, along the Morton curve.
struct LoosePoints {
    std::vector<std::byte> records;  ///< in the schema of the cache
    std::vector<uint64_t> codes;
    std::vector<float> areas;  ///< in faces of the root cube; 0: unknown
};

/// A node whose descendants are finished. Its points stay loose until its parent is finished.
struct LooseNode {
    Pending node;
    LoosePoints points;
};

/// The current state of a build: the finished part, and loose points for the rest. The finished part is the
/// beginning of the Morton curve.
struct GrowingState {
    SourceHeader header;
    /// In any order; entries that are not below a node of `roots` are left out.
    std::span<const format::Entry> settled;
    std::span<const std::shared_ptr<const LooseNode>> roots;  ///< along the Morton curve
    std::shared_ptr<const LoosePoints> sample;                ///< of the whole cloud
    std::shared_ptr<const ByteSource> file;                   ///< the file that holds what is settled
};

/// Makes an octree of the whole state. Every point is in it once: of the sample, only the points after the
/// last root are used. Above the roots, and where there are none, a node takes the first point of each cell
/// of its grid (in Morton order, 128 cells a side) that none of its ancestors took; leaves take the rest.
/// Floors follow from the areas as in a build, so a surface keeps its area at every level of detail while it
/// is replaced. The source shares the state's points and file and never changes.
std::shared_ptr<const NodeSource> make_growing_source(const GrowingState& state);

}  // namespace lucarne::octree
