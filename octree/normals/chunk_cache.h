#pragma once

#include <list>
#include <memory>
#include <mutex>
#include <unordered_map>

#include "octree/normals/normals.h"

namespace lucarne::octree {

using Positions = std::shared_ptr<const std::vector<glm::dvec3>>;

/// The positions of the chunks used last, so that a chunk is not read again for each of its
/// neighbours. Thread-safe. Holds at most `bytes` besides what callers hold themselves.
class ChunkCache {
 public:
    ChunkCache(const ChunkAccess& chunks, uint64_t bytes) : chunks_(chunks), limit_(bytes) {}

    const ChunkAccess& chunks() const { return chunks_; }
    /// Errors: what ChunkAccess::positions reports; coordinates too large for squared distances.
    Result<Positions> positions(size_t chunk);

 private:
    struct Entry {
        size_t chunk;
        Positions positions;
    };
    const ChunkAccess& chunks_;
    uint64_t limit_, held_ = 0;
    std::mutex mutex_;
    std::list<Entry> entries_;  ///< most recently used first
    std::unordered_map<size_t, std::list<Entry>::iterator> found_;
};

}  // namespace lucarne::octree
