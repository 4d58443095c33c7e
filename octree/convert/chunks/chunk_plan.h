#pragma once

#include <algorithm>
#include <cassert>
#include <cstdint>
#include <span>
#include <vector>

#include "io/core/error.h"
#include "octree/tree/key.h"

namespace lucarne::octree {

/// A cube of the octree whose points are built in memory at once.
struct Chunk {
    NodeKey key;
    uint64_t first = 0;  ///< index of its first point in the scratch file
    uint64_t count = 0;
    /// Chained checksum of its records as they were written: `piece` bytes at a time, each seeded by the sum
    /// before.
    uint64_t sum = 0;
    uint32_t piece = 0;
};

/// Points of one cell of kMaxLevel that are too many for a node or a chunk are divided into eight by their
/// order. Returns the index of the first point that goes to the child in `octant`; `octant` 8 is the end.
inline uint64_t stacked_first(uint64_t count, uint32_t octant) {
    return count / 8 * octant + std::min<uint64_t>(count % 8, octant);
}

/// How a build divides its memory (`--memory`).
struct MemoryPlan {
    struct Work {
        uint32_t record = 0;   ///< bytes of a record in the cache
        size_t leaf = 0;       ///< most points of a leaf
        bool normals = false;  ///< normals or areas are estimated; that stage needs more memory
        unsigned threads = 1;
    };
    /// Errors: too little memory for any work.
    static Result<MemoryPlan> create(uint64_t memory, const Work& work);

    uint64_t chunk_points = 0;  ///< most points of a chunk
    unsigned workers = 1;       ///< chunks built at a time
    uint64_t grid_bytes = 0;    ///< for the counting grid
    uint64_t buffer_bytes = 0;  ///< for sorting points into chunks
    uint64_t batch_bytes = 0;   ///< bytes of points read at a time
    unsigned readers = 1;       ///< threads that read an input; each needs some memory
};

/// Counts the points of a cube in a regular grid of cells and joins sparse cells to chunks: cubes of the
/// octree with at most a given number of points, except where the grid is too coarse. (Schuetz et al. 2020,
/// section 3.)
class CountGrid {
 public:
    /// Makes the grid as fine as `bytes` and the number of points justify.
    CountGrid(const NodeKey& cube, uint64_t points, uint64_t bytes);

    void count(const Place& place, uint64_t points = 1) { counts_[cell(place)] += points; }
    std::span<uint64_t> counts() { return counts_; }  ///< by cell; until plan()
    /// Joins cells until the grid is as fine as one made for this number of points. Returns false if it is
    /// too coarse for that.
    bool coarsen_for(uint64_t points, uint64_t bytes);
    /// Returns chunks in Morton order, at most `most` of them (`most` is 64 or more). Each has at most
    /// `limit` points, as far as `most` and the grid allow.
    std::vector<Chunk> plan(uint64_t limit, size_t most);
    /// The index of the chunk that contains a place. Call plan() first.
    uint32_t chunk_of(const Place& place) const { return chunk_of_cell_[cell(place)]; }
    /// Adds up counts by cell to counts by chunk. Call plan() first.
    std::vector<uint64_t> by_chunk(std::span<const uint64_t> cells, size_t chunks) const {
        std::vector<uint64_t> sums(chunks);
        for (size_t i = 0; i < cells.size(); ++i)
            if (cells[i]) sums[chunk_of_cell_[i]] += cells[i];
        return sums;
    }

 private:
    size_t cell(const Place& p) const {
        assert(p.key(cube_.level) == cube_);
        return static_cast<size_t>(p.code() >> (3 * (kMaxLevel - cube_.level - depth_))) & mask_;
    }
    void set_depth(uint32_t depth);
    void join(uint32_t depth, uint64_t index, const NodeKey& key, uint64_t limit,
              std::vector<Chunk>& chunks) const;

    NodeKey cube_;
    uint32_t depth_ = 0;  ///< levels below the cube
    size_t mask_ = 0;
    std::vector<uint64_t> counts_;             ///< along the Morton curve
    std::vector<std::vector<uint64_t>> sums_;  ///< of whole cubes, by depth; the last level is counts_
    std::vector<uint32_t> chunk_of_cell_;
};

}  // namespace lucarne::octree
