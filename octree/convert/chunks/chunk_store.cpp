#include "octree/convert/chunks/chunk_store.h"

#include <algorithm>
#include <cassert>

#include <xxhash.h>

#include "octree/convert/chunks/inputs_changed.h"
#include "octree/convert/chunks/record_bytes.h"

namespace lucarne::octree {
namespace {

constexpr uint64_t kMinBuffer = 8 << 10, kMaxBuffer = 256 << 10;

uint64_t chained_sum(uint64_t before, std::span<const std::byte> piece) {
    return piece.empty() ? before : XXH3_64bits_withSeed(piece.data(), piece.size(), before);
}

/// Collects the records of each chunk and writes them in large pieces.
class Dealer {
 public:
    Dealer(ScratchFile& file, std::span<Chunk> chunks, uint64_t first, uint32_t stride, uint64_t bytes)
        : file_(file), stride_(stride) {
        assert(!chunks.empty());
        const uint64_t each = std::clamp<uint64_t>(bytes / chunks.size(), kMinBuffer, kMaxBuffer);
        capacity_ = std::max<uint64_t>(1, each / stride) * stride;
        for (auto& chunk : chunks) {
            chunk.piece = static_cast<uint32_t>(capacity_);
            lanes_.push_back(
                {chunk, (first + chunk.first) * stride, (first + chunk.first + chunk.count) * stride, {}});
        }
    }

    Result<void> deal(size_t chunk, const std::byte* record) {
        Lane& lane = lanes_[chunk];
        if (lane.waiting.capacity() == 0) lane.waiting.reserve(capacity_);
        lane.waiting.insert(lane.waiting.end(), record, record + stride_);
        return lane.waiting.size() >= capacity_ ? flush(lane) : Result<void>{};
    }

    Result<void> finish() {
        for (auto& lane : lanes_) {
            LUCARNE_TRY(flush(lane));
            if (lane.offset != lane.end) return inputs_changed();
        }
        return {};
    }

 private:
    struct Lane {
        Chunk& chunk;
        uint64_t offset, end;
        std::vector<std::byte> waiting;
    };
    Result<void> flush(Lane& lane) {
        if (lane.waiting.size() > lane.end - lane.offset) return inputs_changed();
        LUCARNE_TRY(file_.write_at(lane.offset, lane.waiting));
        lane.chunk.sum = chained_sum(lane.chunk.sum, lane.waiting);
        lane.offset += lane.waiting.size();
        lane.waiting.clear();
        return {};
    }

    ScratchFile& file_;
    uint32_t stride_;
    uint64_t capacity_;
    std::vector<Lane> lanes_;
};

}  // namespace

Result<ChunkStore> ChunkStore::restore(ScratchFile file, const io::Schema& schema, const Cube& root,
                                       bool stations, std::span<const std::byte> record) {
    ChunkStore store(std::move(file), schema, root, stations);
    ByteReader reader(record);
    store.chunks_ = reader.get_all<Chunk>();
    store.dealt_ = reader.get_all<Chunk>();
    store.end_ = reader.get<uint64_t>();
    store.first_of_rank_ = reader.get_all<uint64_t>();
    const auto own = reader.get<ChunkRange>();
    if (!store.first_of_rank_.empty()) store.own_ = own;
    if (!reader.sound()) return failed("chunks", "have an incomplete record");
    for (const auto& chunk : store.dealt_) LUCARNE_TRY(store.check(chunk));
    return store;
}

std::vector<std::byte> ChunkStore::save() const {
    ByteWriter writer;
    writer.put_all(chunks_);
    writer.put_all(dealt_);
    writer.put(end_);
    writer.put_all(first_of_rank_);
    writer.put(own());
    return writer.take();
}

Result<uint64_t> ChunkStore::sum_of(const Chunk& chunk) const {
    uint64_t sum = 0;
    std::vector<std::byte> piece(chunk.piece);
    const uint64_t begin = chunk.first * schema_.stride, bytes = chunk.count * schema_.stride;
    for (uint64_t at = 0; at < bytes && chunk.piece; at += piece.size()) {
        const auto part = std::span(piece).first(std::min<uint64_t>(piece.size(), bytes - at));
        LUCARNE_TRY(file_.read_at(begin + at, part));
        sum = chained_sum(sum, part);
    }
    return sum;
}

Result<void> ChunkStore::check(const Chunk& chunk) const {
    LUCARNE_ASSIGN(const uint64_t sum, sum_of(chunk));
    return sum == chunk.sum ? Result<void>{} : failed("chunks", "have changed since they were written");
}

Result<void> ChunkStore::fill(const Pass& pass, uint64_t points, const MemoryPlan& memory,
                              std::optional<CountGrid> counted) {
    if (!counted) {
        LUCARNE_ASSIGN(counted, count(pass, {}, points, memory));
    }
    LUCARNE_ASSIGN(auto coarse, distribute(pass, std::move(*counted), points, memory));
    counted.reset();
    return refine(std::move(coarse), memory);
}

Result<std::vector<uint64_t>> ChunkStore::count_in(const GivenCubes& cubes, const Pass& pass) const {
    std::vector<uint64_t> counts(cubes.size() + 1);
    LUCARNE_TRY(pass([&](std::span<const std::byte> records) -> Result<void> {
        for (size_t at = 0; at < records.size(); at += schema_.stride)
            ++counts[cubes.of(root_.place(io::position_of(schema_, &records[at])))];
        return {};
    }));
    counts.pop_back();  // those outside
    return counts;
}

/// Writes the points in as many cubes as there are chunks, from `first` on, to the places of the chunks.
Result<void> ChunkStore::deal(const Pass& pass, const GivenCubes& cubes, size_t first,
                              std::span<Chunk> chunks, const MemoryPlan& memory) {
    if (chunks.empty()) return {};
    Dealer dealer(file_, chunks, 0, schema_.stride, memory.buffer_bytes);
    const auto each = [&](std::span<const std::byte> records) -> Result<void> {
        for (size_t at = 0; at < records.size(); at += schema_.stride) {
            const size_t cube = cubes.of(root_.place(io::position_of(schema_, &records[at])));
            if (cube >= first && cube - first < chunks.size())
                LUCARNE_TRY(dealer.deal(cube - first, &records[at]));
        }
        return {};
    };
    LUCARNE_TRY(pass(each));
    return dealer.finish();
}

Result<void> ChunkStore::fill(const Pass& pass, const GivenCubes& cubes, const MemoryPlan& memory) {
    LUCARNE_ASSIGN(const auto counts, count_in(cubes, pass));
    for (size_t cube = 0; cube < cubes.size(); ++cube) {
        chunks_.push_back({.key = cubes.key(cube), .first = end_, .count = counts[cube]});
        end_ += counts[cube];
    }
    return deal(pass, cubes, 0, chunks_, memory);
}

/// Counts the points of `cube` in a grid.
Result<CountGrid> ChunkStore::count(const Pass& pass, const NodeKey& cube, uint64_t points,
                                    const MemoryPlan& memory) const {
    CountGrid grid(cube, points, memory.grid_bytes);
    LUCARNE_TRY(pass([&](std::span<const std::byte> records) -> Result<void> {
        for (size_t at = 0; at < records.size(); at += schema_.stride)
            grid.count(root_.place(io::position_of(schema_, &records[at])));
        return {};
    }));
    return grid;
}

/// Returns how many chunks have a buffer at a time.
size_t ChunkStore::most_chunks(const MemoryPlan& memory, uint32_t stride) {
    return std::max<uint64_t>(64, memory.buffer_bytes / std::max<uint64_t>(kMinBuffer, stride));
}

/// Distributes the points that `grid` counted: they become chunks at the end of the scratch file.
Result<std::vector<Chunk>> ChunkStore::distribute(const Pass& pass, CountGrid grid, uint64_t points,
                                                  const MemoryPlan& memory) {
    const uint32_t stride = schema_.stride;
    std::vector<Chunk> chunks = grid.plan(memory.chunk_points, most_chunks(memory, stride));
    uint64_t counted = 0;
    for (const auto& chunk : chunks) counted += chunk.count;
    if (counted != points) return inputs_changed();
    Dealer dealer(file_, chunks, end_, stride, memory.buffer_bytes);
    const auto deal = [&](std::span<const std::byte> records) -> Result<void> {
        for (size_t at = 0; at < records.size(); at += stride)
            LUCARNE_TRY(dealer.deal(grid.chunk_of(root_.place(io::position_of(schema_, &records[at]))),
                                    &records[at]));
        return {};
    };
    LUCARNE_TRY(pass(deal));
    LUCARNE_TRY(dealer.finish());
    for (auto& chunk : chunks) chunk.first += end_;
    end_ += points;
    return chunks;
}

/// Divides the points of one place by their order, without moving them.
void ChunkStore::stack(const Chunk& chunk, uint64_t limit) {
    if (chunk.count <= limit || chunk.key.level == kMostLevel) {
        chunks_.push_back(chunk);
        return;
    }
    for (uint32_t octant = 0; octant < 8; ++octant) {
        const uint64_t first = stacked_first(chunk.count, octant),
                       end = stacked_first(chunk.count, octant + 1);
        stack({chunk.key.child(octant), chunk.first + first, end - first}, limit);
    }
}

/// Splits chunks that are still too large, down to the end of the Morton code and beyond.
Result<void> ChunkStore::refine(std::vector<Chunk> coarse, const MemoryPlan& memory) {
    for (const Chunk& chunk : coarse) {
        if (chunk.count <= memory.chunk_points || chunk.key.level == kMaxLevel) {
            dealt_.push_back(chunk);
            stack(chunk, memory.chunk_points);
            continue;
        }
        const Pass pass = pass_over(chunk, memory);
        LUCARNE_ASSIGN(auto grid, count(pass, chunk.key, chunk.count, memory));
        LUCARNE_ASSIGN(auto finer, distribute(pass, std::move(grid), chunk.count, memory));
        file_.discard(chunk.first * schema_.stride, chunk.count * schema_.stride);
        LUCARNE_TRY(refine(std::move(finer), memory));  // a level deeper each time, so at most 21 deep
    }
    return {};
}

Pass ChunkStore::pass_over(const Chunk& chunk, const MemoryPlan& memory) {
    return [this, chunk, most = std::max<uint64_t>(1, memory.batch_bytes / schema_.stride)](
               const Visit& visit) -> Result<void> {
        std::vector<std::byte> records;
        for (uint64_t done = 0; done < chunk.count; done += most) {
            records.resize(std::min(most, chunk.count - done) * schema_.stride);
            LUCARNE_TRY(file_.read_at((chunk.first + done) * schema_.stride, records));
            LUCARNE_TRY(visit(records));
        }
        return {};
    };
}

Result<std::vector<std::byte>> ChunkStore::load(size_t chunk, uint64_t first, uint64_t count) const {
    assert(own().contains(chunk) && first + count <= chunks_[chunk].count);
    std::vector<std::byte> records(count * schema_.stride);
    LUCARNE_TRY(file_.read_at((chunks_[chunk].first + first) * schema_.stride, records));
    return records;
}

void ChunkStore::discard(size_t chunk) {
    file_.discard(chunks_[chunk].first * schema_.stride, chunks_[chunk].count * schema_.stride);
}

}  // namespace lucarne::octree
