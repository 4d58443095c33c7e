#include "octree/convert/chunks/chunk_plan.h"

#include <algorithm>
#include <cassert>

#include <fmt/format.h>

#include "io/core/options.h"
#include "octree/normals/normals.h"

namespace lucarne::octree {
namespace {

// Larger chunks sort more slowly and distribute worse among threads.
constexpr uint64_t kMaxChunkPoints = 1'000'000;
constexpr uint64_t kMinMemory = uint64_t{16} << 20;
/// Memory of a thread that decodes LAZ (io/formats/las/laz/reader.cpp); all of them together get at most
/// 1/kReaderShare of the memory.
constexpr uint64_t kReaderBytes = uint64_t{8} << 20, kReaderShare = 8;
constexpr uint64_t kBytesPerCell = 8 + 2 + 4;  // its count, its share of the sums, its chunk number
/// Memory of the build per point besides two copies of its record: sort keys twice, then code, place, area,
/// samples.
constexpr uint64_t kWorkPerPoint = 48;
/// The normals stage holds about this many chunks at a time, including a chunk's neighbours. Building needs
/// fewer.
constexpr uint64_t kNormalChunks = 4;
/// Memory per candidate while a node is sampled.
constexpr uint64_t kWorkPerCandidate = 48;

/// Returns how many levels below its cube a grid has that counts `points` points in `bytes` bytes.
uint32_t grid_depth(const NodeKey& cube, uint64_t points, uint64_t bytes) {
    const uint64_t cells = std::min(bytes / kBytesPerCell, std::max<uint64_t>(points / 16, 512));
    uint32_t depth = 0;
    while (depth < 8 && cube.level + depth < kMaxLevel && uint64_t{1} << (3 * (depth + 1)) <= cells) ++depth;
    return depth;
}

}  // namespace

Result<MemoryPlan> MemoryPlan::create(uint64_t bytes, const Work& work) {
    if (bytes < kMinMemory)
        return bad_arguments("--memory", fmt::format("{} is too little", bytes_text(bytes)),
                             fmt::format("give at least {}", bytes_text(kMinMemory)));
    const uint64_t per_point = 2 * uint64_t{work.record} + kWorkPerPoint;
    // Eight samples with the points of two leaves each.
    const uint64_t sampling = 16 * work.leaf * kWorkPerCandidate;
    // Returns how many points fit for each of `workers` workers. The assembly samples as well; a single
    // worker takes turns with it.
    const auto room = [&](unsigned workers) {
        const uint64_t share = bytes * 7 / 8, taken = sampling * (workers > 1 ? workers + 1 : 1);
        return share > taken ? (share - taken) / workers / per_point : 0;
    };
    // Chunks must not depend on the number of threads, because orientation is propagated chunk by chunk.
    MemoryPlan plan{.workers = std::max(1u, work.threads)};
    plan.chunk_points = std::max<uint64_t>(
        work.leaf, std::min({room(1), bytes / (kNormalChunks * kNormalBytesPerPoint), kMaxChunkPoints}));
    while (plan.workers > 1 && room(plan.workers) < plan.chunk_points) --plan.workers;
    plan.grid_bytes = bytes / 4;
    plan.buffer_bytes = bytes / 2;
    plan.batch_bytes = std::min<uint64_t>(bytes / 16, 1 << 20);
    plan.readers = static_cast<unsigned>(
        std::clamp<uint64_t>(bytes / kReaderShare / kReaderBytes, 1, std::max(1u, work.threads)));
    return plan;
}

CountGrid::CountGrid(const NodeKey& cube, uint64_t points, uint64_t bytes) : cube_(cube) {
    set_depth(grid_depth(cube, points, bytes));
    counts_.assign(mask_ + 1, 0);
}

void CountGrid::set_depth(uint32_t depth) {
    depth_ = depth;
    mask_ = (size_t{1} << (3 * depth)) - 1;
}

bool CountGrid::coarsen_for(uint64_t points, uint64_t bytes) {
    const uint32_t depth = grid_depth(cube_, points, bytes);
    if (depth > depth_) return false;
    while (depth_ > depth) {
        set_depth(depth_ - 1);
        // Each cell is in front of those that it is the sum of, so that the sums can overwrite the counts.
        for (size_t i = 0; i <= mask_; ++i) {
            uint64_t sum = 0;
            for (size_t octant = 0; octant < 8; ++octant) sum += counts_[8 * i + octant];
            counts_[i] = sum;
        }
        counts_.resize(mask_ + 1);
    }
    counts_.shrink_to_fit();
    return true;
}

void CountGrid::join(uint32_t depth, uint64_t index, const NodeKey& key, uint64_t limit,
                     std::vector<Chunk>& chunks) const {
    const uint64_t sum = depth == depth_ ? counts_[index] : sums_[depth][index];
    if (sum == 0) return;
    if (sum <= limit || depth == depth_) {
        chunks.push_back({key, 0, sum});
        return;
    }
    for (uint32_t octant = 0; octant < 8; ++octant)
        join(depth + 1, index * 8 + octant, key.child(octant), limit, chunks);
}

std::vector<Chunk> CountGrid::plan(uint64_t limit, size_t most) {
    sums_.resize(depth_);
    for (uint32_t depth = depth_; depth-- > 0;) {
        const auto& finer = depth + 1 == depth_ ? counts_ : sums_[depth + 1];
        sums_[depth].assign(finer.size() / 8, 0);
        for (size_t i = 0; i < finer.size(); ++i) sums_[depth][i / 8] += finer[i];
    }
    const uint64_t all = depth_ ? sums_[0][0] : counts_[0];
    std::vector<Chunk> chunks;
    // Any limit below the total splits the cube. The largest such limit gives at most 64 chunks, because the
    // path down to the densest cell has seven neighbours a level.
    const uint64_t widest = limit < all ? all - 1 : limit;
    for (;; limit = std::min(2 * limit, widest)) {
        chunks.clear();
        join(0, 0, cube_, limit, chunks);
        if (chunks.size() <= most || limit >= widest) break;
    }
    chunk_of_cell_.assign(counts_.size(), 0);
    uint64_t first = 0;
    for (uint32_t i = 0; i < chunks.size(); ++i) {
        chunks[i].first = first;
        first += chunks[i].count;
        const uint32_t below = depth_ - (chunks[i].key.level - cube_.level);
        const NodeKey key = chunks[i].key;
        const size_t begin = static_cast<size_t>(key.code() << (3 * below)) & mask_;
        std::fill_n(chunk_of_cell_.begin() + static_cast<std::ptrdiff_t>(begin), size_t{1} << (3 * below), i);
    }
    assert(first == all);
    counts_ = {};
    sums_ = {};
    return chunks;
}

}  // namespace lucarne::octree
