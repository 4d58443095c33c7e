#pragma once

#include <algorithm>
#include <functional>
#include <optional>
#include <span>
#include <vector>

#include "io/files/file.h"
#include "octree/cluster/ranks.h"
#include "octree/convert/chunks/chunk_plan.h"
#include "octree/convert/chunks/given_cubes.h"
#include "octree/normals/normals.h"
#include "octree/tree/source.h"

namespace lucarne::octree {

using Visit = std::function<Result<void>(std::span<const std::byte> records)>;
/// Calls its argument with all records of a source, in order, piece by piece. Can be called repeatedly.
using Pass = std::function<Result<void>(const Visit&)>;

/// Bytes behind each record of a ChunkStore with stations: u16, 1 + the index of the estimated station that
/// saw the point, 0 if unknown.
inline constexpr uint32_t kStationBytes = 2;
/// Bytes of a step of the checksum of a chunk that came from other ranks.
inline constexpr uint32_t kSummed = 256 << 10;

/// The points of a build, sorted into chunks in one scratch file. Within a chunk they keep the order of the
/// input, so that nothing depends on timing.
class ChunkStore {
 public:
    /// `schema` is that of the points. `stations`: their records are followed by kStationBytes
    /// (point_stations.h).
    ChunkStore(ScratchFile file, const io::Schema& schema, const Cube& root, bool stations = false)
        : file_(std::move(file)), points_schema_(schema), schema_(schema), root_(root) {
        if (stations) schema_.stride += kStationBytes;
    }
    /// Restores a store whose scratch file still exists from the record that `save` made. Errors: the file's
    /// points have changed.
    static Result<ChunkStore> restore(ScratchFile file, const io::Schema& schema, const Cube& root,
                                      bool stations, std::span<const std::byte> record);
    std::vector<std::byte> save() const;

    /// Sorts `points` points into chunks. Runs the pass twice: to count the points and to distribute them.
    /// `counted` spares the first: the points' counts in a grid of the root cube made for `points` points and
    /// the grid's share of the memory.
    Result<void> fill(const Pass& pass, uint64_t points, const MemoryPlan& memory,
                      std::optional<CountGrid> counted = {});

    /// Sorts points into the given chunks instead. Points outside all of them are left out; chunks may be
    /// empty.
    Result<void> fill(const Pass& pass, const GivenCubes& cubes, const MemoryPlan& memory);
    /// Counts the points of a pass in each cube.
    Result<std::vector<uint64_t>> count_in(const GivenCubes& cubes, const Pass& pass) const;

    /// Sorts the points of all ranks into chunks, each of which goes to one rank: the same chunks as one
    /// process makes of all inputs. A meeting of the ranks. `own`: the points that this rank reads; the ranks
    /// read consecutive parts of the inputs. `points`: of all ranks. `counted`: as above, of this rank's
    /// points; all ranks have it or none. `resumable`: the store will be saved. `first_has`: the work that
    /// rank 0 does alone, in points; its chunks have fewer.
    Result<void> fill(const Pass& own, uint64_t points, const MemoryPlan& memory, Ranks& ranks,
                      bool resumable, std::optional<CountGrid> counted, uint64_t first_has = 0);
    /// What this rank contributes to chunks that are given.
    struct Given {
        Pass present;  ///< points that the rank gets itself; those in cubes of other ranks are left out
        Pass added;    ///< points that the ranks share out as above; all of them are in the cubes
        std::span<const uint64_t> counts;       ///< of `added` in each cube
        std::span<const size_t> first_of_rank;  ///< the first cube of each rank, and the number of cubes
    };
    /// Sorts points into the given chunks of all ranks. A chunk has the points that were present before those
    /// that are added. Chunks that are too large are split, and chunks without points are left out. A
    /// meeting.
    Result<void> fill(const Given& given, const GivenCubes& cubes, const MemoryPlan& memory, Ranks& ranks);
    /// Fills the store with this rank's share of the chunks that another number of ranks has made. `parts`:
    /// those that are in this process; together the ranks have all. `all`: all chunks. A meeting.
    Result<void> take_over(std::span<const ChunkStore* const> parts, std::span<const Chunk> all,
                           const MemoryPlan& memory, Ranks& ranks);
    /// The chunks in this process; of the others only their cubes and counts are known.
    ChunkRange own() const { return own_ ? *own_ : ChunkRange{0, chunks_.size()}; }
    /// The rank that has a chunk.
    size_t owner(size_t chunk) const {
        return static_cast<size_t>(std::ranges::upper_bound(first_of_rank_, chunk) - first_of_rank_.begin()) -
               1;
    }

    /// In Morton order. A chunk has more than MemoryPlan::chunk_points points only where the Morton code is
    /// exhausted.
    std::span<const Chunk> chunks() const { return chunks_; }
    /// Of the records. Its stride includes the kStationBytes of a store with stations.
    const io::Schema& schema() const { return schema_; }
    const io::Schema& points_schema() const { return points_schema_; }
    /// Returns the index of the estimated station that saw a point, -1 if unknown.
    int32_t estimated_station(const std::byte* record) const {
        if (schema_.stride == points_schema_.stride) return -1;
        return int32_t{io::load<uint16_t>(record + points_schema_.stride)} - 1;
    }
    const Cube& root() const { return root_; }
    /// Returns the points [first, first + count) of a chunk.
    Result<std::vector<std::byte>> load(size_t chunk, uint64_t first, uint64_t count) const;
    /// Frees a chunk's space on disk.
    void discard(size_t chunk);

 private:
    Result<uint64_t> sum_of(const Chunk& chunk) const;
    Result<void> check(const Chunk& chunk) const;
    Result<CountGrid> count(const Pass& pass, const NodeKey& cube, uint64_t points,
                            const MemoryPlan& memory) const;
    Result<std::vector<Chunk>> distribute(const Pass& pass, CountGrid grid, uint64_t points,
                                          const MemoryPlan& memory);
    Result<void> deal(const Pass& pass, const GivenCubes& cubes, size_t first, std::span<Chunk> chunks,
                      const MemoryPlan& memory);
    Result<void> refine(std::vector<Chunk> coarse, const MemoryPlan& memory);
    Result<void> learn_others(Ranks& ranks);
    static size_t most_chunks(const MemoryPlan& memory, uint32_t stride);
    void stack(const Chunk& chunk, uint64_t limit);
    Pass pass_over(const Chunk& chunk, const MemoryPlan& memory);

    ScratchFile file_;
    io::Schema points_schema_, schema_;
    Cube root_;
    std::vector<Chunk> chunks_;
    std::vector<Chunk> dealt_;             ///< the chunks as written, before those of one place were divided
    std::optional<ChunkRange> own_;        ///< empty: all
    std::vector<uint64_t> first_of_rank_;  ///< the first chunk of each rank, and the end
    uint64_t end_ = 0;  ///< points written so far, including those of chunks that were split again
};

}  // namespace lucarne::octree
