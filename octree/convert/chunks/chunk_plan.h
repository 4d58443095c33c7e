#pragma once

#include <algorithm>
#include <cstdint>
#include <vector>

#include "io/core/error.h"
#include "octree/tree/key.h"

namespace lucarne::octree {

/// A cube of the octree whose points are built in memory at once.
struct Chunk {
    NodeKey key;
    uint64_t first = 0;  ///< its first point in the scratch file
    uint64_t count = 0;
    /// Of its records as they were dealt out, `piece` bytes at a time, each seeded by the last.
    uint64_t sum = 0;
    uint32_t piece = 0;
};

/// Where the points of one cell of kMaxLevel are more than a node or a chunk holds, they are divided into
/// eight by their order: the first that the child in an octant gets; `octant` 8 is the end.
inline uint64_t stacked_first(uint64_t count, uint32_t octant) {
    return count / 8 * octant + std::min<uint64_t>(count % 8, octant);
}

/// How a build shares out `--memory`.
struct MemoryPlan {
    struct Work {
        uint32_t record = 0;   ///< bytes of a record in the cache
        size_t leaf = 0;       ///< most points of a leaf
        bool normals = false;  ///< normals or areas are estimated: that stage needs more at the least
        unsigned threads = 1;
    };
    /// Errors: too little memory for any work.
    static Result<MemoryPlan> create(uint64_t memory, const Work& work);

    uint64_t chunk_points = 0;  ///< most points of a chunk
    unsigned workers = 1;       ///< chunks built at a time
    uint64_t grid_bytes = 0;    ///< for counting
    uint64_t buffer_bytes = 0;  ///< for dealing points out to chunks
    uint64_t batch_bytes = 0;   ///< of points read at a time
    unsigned readers = 1;       ///< threads that read an input; each holds some of it
};

/// Counts the points of a cube in a regular grid of cells and joins sparse cells to chunks: cubes of the
/// octree with at most a given number of points, except where the grid is too coarse. (Schuetz et al. 2020,
/// section 3.)
class CountGrid {
 public:
    /// As fine as `bytes` and the number of points justify.
    CountGrid(const NodeKey& cube, uint64_t points, uint64_t bytes);

    void count(const Place& place, uint64_t points = 1) { counts_[cell(place)] += points; }
    /// Chunks in Morton order, at most `most` of them (64 or more); `limit` points each where that allows it.
    std::vector<Chunk> plan(uint64_t limit, size_t most);
    /// After plan: the index of the chunk that holds a place.
    uint32_t chunk_of(const Place& place) const { return chunk_of_cell_[cell(place)]; }

 private:
    size_t cell(const Place& p) const {
        return static_cast<size_t>(p.code() >> (3 * (kMaxLevel - cube_.level - depth_))) & mask_;
    }
    void join(uint32_t depth, uint64_t index, const NodeKey& key, uint64_t limit,
              std::vector<Chunk>& chunks) const;

    NodeKey cube_;
    uint32_t depth_ = 0;  ///< levels under the cube
    size_t mask_ = 0;
    std::vector<uint64_t> counts_;             ///< along the Morton curve
    std::vector<std::vector<uint64_t>> sums_;  ///< of whole cubes, by depth; the last is counts_
    std::vector<uint32_t> chunk_of_cell_;
};

}  // namespace lucarne::octree
