#pragma once

#include <functional>
#include <span>
#include <vector>

#include "io/files/file.h"
#include "octree/convert/chunks/chunk_plan.h"
#include "octree/tree/source.h"

namespace lucarne::octree {

using Visit = std::function<Result<void>(std::span<const std::byte> records)>;
/// Calls its argument with all records of something, in their order, piece by piece. Can be called again.
using Pass = std::function<Result<void>(const Visit&)>;

/// The points of a build, sorted into chunks in one scratch file; within a chunk in the order of the input,
/// so that nothing depends on timing.
class ChunkStore {
 public:
    ChunkStore(ScratchFile file, const io::Schema& schema, const Cube& root)
        : file_(std::move(file)), schema_(schema), root_(root) {}
    /// What `save` wrote down about a store whose scratch file is still there. Errors: a file that does not
    /// hold what was dealt out.
    static Result<ChunkStore> restore(ScratchFile file, const io::Schema& schema, const Cube& root,
                                      std::span<const std::byte> record);
    std::vector<std::byte> save() const;

    /// Reads `points` points twice: to count them and to deal them out.
    Result<void> fill(const Pass& pass, uint64_t points, const MemoryPlan& memory);

    /// Deals points out to given chunks instead, disjoint cubes of kMaxLevel or above in Morton order, and,
    /// if `split`, splits those that are too large and leaves out those without any points. Points outside
    /// all of them are left out.
    Result<void> fill(const Pass& pass, std::span<const NodeKey> cubes, bool split, const MemoryPlan& memory);

    /// In Morton order. More than MemoryPlan::chunk_points only where the Morton code is exhausted.
    std::span<const Chunk> chunks() const { return chunks_; }
    const io::Schema& schema() const { return schema_; }
    const Cube& root() const { return root_; }
    /// Points [first, first + count) of a chunk.
    Result<std::vector<std::byte>> load(size_t chunk, uint64_t first, uint64_t count) const;
    /// Frees a chunk's place on disk.
    void discard(size_t chunk);

 private:
    Result<void> check(const Chunk& chunk) const;
    Result<std::vector<Chunk>> split(const Pass& pass, const NodeKey& cube, uint64_t points,
                                     const MemoryPlan& memory);
    Result<void> refine(std::vector<Chunk> coarse, const MemoryPlan& memory);
    void stack(const Chunk& chunk, uint64_t limit);
    Pass pass_over(const Chunk& chunk, const MemoryPlan& memory);

    ScratchFile file_;
    io::Schema schema_;
    Cube root_;
    std::vector<Chunk> chunks_;
    std::vector<Chunk> dealt_;  ///< the same points as they were dealt out, before one place's were divided
    uint64_t end_ = 0;          ///< points written so far, those of chunks split again included
};

}  // namespace lucarne::octree
