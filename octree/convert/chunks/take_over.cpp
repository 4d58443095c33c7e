// Dividing the chunks and normals that another number of ranks has left.
#include <numeric>

#include "octree/convert/chunks/chunk_store.h"
#include "octree/convert/chunks/move_pieces.h"
#include "octree/convert/chunks/record_bytes.h"
#include "octree/convert/chunks/surface_store.h"

namespace lucarne::octree {

Result<void> ChunkStore::take_over(std::span<const ChunkStore* const> parts, std::span<const Chunk> all,
                                   const MemoryPlan& memory, Ranks& ranks) {
    chunks_.assign(all.begin(), all.end());
    std::vector<uint64_t> weights;
    for (const Chunk& chunk : chunks_) weights.push_back(chunk.count);
    first_of_rank_.clear();
    for (const size_t first : divide(weights, ranks.count())) first_of_rank_.push_back(first);
    own_ = ChunkRange{first_of_rank_[ranks.rank()], first_of_rank_[ranks.rank() + 1]};
    for (size_t rank = 0; rank < ranks.count(); ++rank)
        for (uint64_t chunk = first_of_rank_[rank], end = 0; chunk < first_of_rank_[rank + 1]; ++chunk) {
            chunks_[chunk].first = end;
            end += chunks_[chunk].count;
        }
    end_ = std::accumulate(weights.begin() + static_cast<ptrdiff_t>(own_->first),
                           weights.begin() + static_cast<ptrdiff_t>(own_->end), uint64_t{0});
    const uint64_t stride = schema_.stride;
    std::vector<MovedPiece> pieces;
    for (const ChunkStore* part : parts)
        for (size_t i = part->own().first; i < part->own().end; ++i)
            pieces.push_back({&part->file_, part->chunks_[i].first * stride, weights[i] * stride, owner(i),
                              chunks_[i].first * stride});
    LUCARNE_TRY(move_pieces(ranks, pieces, file_, end_ * stride, memory.buffer_bytes));
    for (size_t i = own_->first; i < own_->end; ++i) {
        dealt_.push_back(chunks_[i]);
        dealt_.back().piece = kSummed;
        LUCARNE_ASSIGN(dealt_.back().sum, sum_of(dealt_.back()));
    }
    return {};
}

Result<SurfaceStore> SurfaceStore::take_over(std::span<const Part> parts, const ChunkStore& chunks,
                                             ScratchFile file, const MemoryPlan& memory, Ranks& ranks) {
    SurfaceStore store(std::move(file), chunks);
    std::vector<MovedPiece> pieces;
    std::vector<ByteWriter> writers(ranks.count());
    for (const Part& part : parts)
        for (size_t i = part.chunks->own().first; i < part.chunks->own().end; ++i) {
            const SurfaceStore& from = *part.surface;
            const size_t rank = chunks.owner(i);
            // A rank's part of either file has one chunk behind the other.
            pieces.push_back({&from.file_, from.first_[i] * sizeof(Point), from.count(i) * sizeof(Point),
                              rank, chunks.chunks()[i].first * sizeof(Point)});
            writers[rank].put(uint64_t{i});
            writers[rank].put(from.sums_[i]);
            writers[rank].put(from.most_stray_area_);
            writers[rank].put_all(i < from.signs_.size() ? from.signs_[i] : std::vector<int32_t>());
        }
    LUCARNE_TRY(move_pieces(ranks, pieces, store.file_, store.end_ * sizeof(Point), memory.buffer_bytes));
    std::vector<Ranks::Bytes> parcels;
    for (ByteWriter& writer : writers) parcels.push_back(writer.take());
    LUCARNE_ASSIGN(const auto received, ranks.exchange(parcels));
    store.signs_.resize(chunks.chunks().size());
    for (const Ranks::Bytes& parcel : received)
        for (ByteReader reader(parcel); reader.left() > 0;) {
            const auto chunk = reader.get<uint64_t>();
            if (!chunks.own().contains(chunk)) return failed("normals", "arrived for another rank's chunk");
            store.sums_[chunk] = reader.get<uint64_t>();
            store.most_stray_area_ = reader.get<float>();
            store.signs_[chunk] = reader.get_all<int32_t>();
            if (!reader.sound()) return failed("normals", "arrived incomplete");
        }
    return store;
}

}  // namespace lucarne::octree
