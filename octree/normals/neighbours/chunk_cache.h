#pragma once

#include <list>
#include <memory>
#include <mutex>
#include <unordered_map>

#include "octree/normals/normals.h"

namespace lucarne::octree {

using Positions = std::shared_ptr<const std::vector<glm::dvec3>>;

/// Caches the positions of the chunks used last, so that a chunk is not read again for each of its
/// neighbours. Thread-safe. Holds at most `bytes` besides the chunks that callers hold themselves.
///
/// Positions and bounds are multiplied by a power of two that brings the widest extent of the cloud to about
/// 2^50. Floats can then represent the squares of all distances from the extent down to its 10^-34th part,
/// whatever the cloud's unit and size. Scaling by a power of two is exact.
class ChunkCache {
 public:
    ChunkCache(const ChunkAccess& chunks, uint64_t bytes);

    const ChunkAccess& chunks() const { return chunks_; }
    double scale() const { return scale_; }
    /// Returns a chunk's positions, scaled. Errors: what ChunkAccess::positions reports; a coordinate that is
    /// not a finite number.
    Result<Positions> positions(size_t chunk);
    /// Points of a chunk, scaled.
    struct Near {
        Positions positions;
        std::vector<uint32_t> indices;  ///< in the chunk's stored order; empty: `positions` are all of them
        uint32_t index(size_t i) const { return indices.empty() ? static_cast<uint32_t>(i) : indices[i]; }
    };
    /// Returns at least the points of a chunk in a scaled box.
    Result<Near> near(size_t chunk, const Box& box);
    Box bounds(size_t chunk) const;  ///< scaled

 private:
    struct Entry {
        size_t chunk;
        Positions positions;
    };
    Result<Positions> scaled(std::vector<glm::dvec3> positions) const;

    const ChunkAccess& chunks_;
    uint64_t limit_, held_ = 0;
    double scale_;
    std::mutex mutex_;
    std::list<Entry> entries_;  ///< most recently used first
    std::unordered_map<size_t, std::list<Entry>::iterator> found_;
};

}  // namespace lucarne::octree
