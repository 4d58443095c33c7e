// Sorting the points of several ranks into chunks.
#include <cassert>
#include <cstring>
#include <functional>
#include <numeric>

#include "octree/cluster/rounds.h"
#include "octree/convert/chunks/chunk_store.h"
#include "octree/convert/chunks/inputs_changed.h"

namespace lucarne::octree {
namespace {

using Bytes = Ranks::Bytes;

template <class T>
Bytes as_parcel(std::span<const T> values) {
    const auto bytes = std::as_bytes(values);
    return {bytes.begin(), bytes.end()};
}
template <class T>
std::vector<T> from_parcel(const Bytes& parcel) {
    std::vector<T> values(parcel.size() / sizeof(T));
    if (!values.empty()) std::memcpy(values.data(), parcel.data(), values.size() * sizeof(T));
    return values;
}

/// Where the next record of a sender goes in a chunk, and where its records must end.
struct Lane {
    uint64_t next = 0, end = 0;
};

/// Sends the records of this rank to the owners of their chunks, in rounds that all ranks make together, and
/// writes those that arrive. In a chunk, the records of a rank come after those of lower ranks, in the order
/// in which they were read.
class Delivery {
 public:
    /// Tells the chunk of a place; a number that no chunk has if it is in none.
    using ChunkOf = std::function<size_t(const Place&)>;

    /// `lanes`: of each sender, of each chunk of this rank.
    Delivery(Ranks& ranks, ScratchFile& file, const io::Schema& schema, const Cube& root, ChunkOf chunk_of,
             std::span<const size_t> first_of_rank, std::vector<std::vector<Lane>> lanes, uint64_t bytes)
        : ranks_(ranks),
          file_(file),
          schema_(schema),
          root_(root),
          find_(std::move(chunk_of)),
          stride_(schema.stride),
          first_(first_of_rank.begin(), first_of_rank.end()),
          lanes_(std::move(lanes)),
          rounds_(ranks, bytes,
                  [this](size_t sender, std::span<const std::byte> got) { return store(sender, got); }) {
        for (size_t rank = 0; rank < ranks.count(); ++rank)
            rank_of_.resize(first_[rank + 1], static_cast<uint32_t>(rank));
    }

    Result<void> take(std::span<const std::byte> records) {
        for (size_t at = 0; at < records.size(); at += stride_) {
            const size_t chunk = chunk_of(&records[at]);
            if (chunk >= rank_of_.size()) return inputs_changed();
            const uint32_t rank = rank_of_[chunk];
            rounds_.add(rank, records.subspan(at, stride_));
            if (rounds_.room(rank) < stride_) LUCARNE_TRY(rounds_.next());
        }
        return {};
    }
    Result<void> finish() {
        LUCARNE_TRY(rounds_.finish());
        for (const auto& sender : lanes_)
            for (const Lane& lane : sender)
                if (lane.next != lane.end) return inputs_changed();
        return {};
    }

 private:
    /// Writes the records of one sender, those of a chunk in one piece.
    Result<void> store(size_t sender, std::span<const std::byte> records) {
        const size_t own = first_[ranks_.rank()], count = records.size() / stride_;
        if (count == 0) return {};
        auto& lanes = lanes_[sender];
        chunks_.resize(count);
        starts_.assign(lanes.size() + 1, 0);
        for (size_t i = 0; i < count; ++i) {
            chunks_[i] = static_cast<uint32_t>(chunk_of(&records[i * stride_]) - own);
            assert(chunks_[i] < lanes.size());
            ++starts_[chunks_[i] + 1];
        }
        std::partial_sum(starts_.begin(), starts_.end(), starts_.begin());
        sorted_.resize(records.size());
        for (size_t i = 0; i < count; ++i)
            std::memcpy(&sorted_[starts_[chunks_[i]]++ * stride_], &records[i * stride_], stride_);
        for (size_t chunk = 0, begin = 0; chunk < lanes.size(); begin = starts_[chunk++]) {
            const uint64_t arrived = starts_[chunk] - begin;
            if (arrived == 0) continue;
            if (arrived > lanes[chunk].end - lanes[chunk].next) return inputs_changed();
            LUCARNE_TRY(file_.write_at(lanes[chunk].next * stride_,
                                       std::span(sorted_).subspan(begin * stride_, arrived * stride_)));
            lanes[chunk].next += arrived;
        }
        return {};
    }

    size_t chunk_of(const std::byte* record) const {
        return find_(root_.place(io::position_of(schema_, record)));
    }

    Ranks& ranks_;
    ScratchFile& file_;
    const io::Schema& schema_;
    const Cube& root_;
    ChunkOf find_;
    uint32_t stride_;
    std::vector<size_t> first_;
    std::vector<std::vector<Lane>> lanes_;
    std::vector<uint32_t> rank_of_;  ///< by chunk
    Rounds rounds_;
    std::vector<uint32_t> chunks_;
    std::vector<size_t> starts_;
    Bytes sorted_;
};

/// Tells each rank how many records of its chunks this rank has. Returns where those of each rank go, of each
/// chunk of this rank. `present`: records that come first in each of these, empty for none.
Result<std::vector<std::vector<Lane>>> plan_lanes(Ranks& ranks, std::span<const uint64_t> counts,
                                                  std::span<const size_t> first_of_rank,
                                                  std::span<const uint64_t> present = {}) {
    std::vector<Bytes> parcels;
    for (size_t rank = 0; rank < ranks.count(); ++rank)
        parcels.push_back(
            as_parcel(counts.subspan(first_of_rank[rank], first_of_rank[rank + 1] - first_of_rank[rank])));
    LUCARNE_ASSIGN(const auto received, ranks.exchange(parcels));
    std::vector<std::vector<Lane>> lanes;
    for (const Bytes& parcel : received) {
        auto& of_sender = lanes.emplace_back();
        for (const uint64_t count : from_parcel<uint64_t>(parcel)) of_sender.push_back({0, count});
    }
    uint64_t end = 0;
    for (size_t chunk = 0; chunk < lanes[0].size(); ++chunk) {
        if (!present.empty()) end += present[chunk];
        for (auto& sender : lanes) {
            sender[chunk].next = end;
            end = sender[chunk].end += end;
        }
    }
    return lanes;
}

Result<void> deliver(Ranks& ranks, const Pass& pass, Delivery& delivery) {
    LUCARNE_TRY(pass([&](std::span<const std::byte> records) -> Result<void> {
        if (ranks.stopped()) return failed("the conversion", "has failed on another rank");
        return delivery.take(records);
    }));
    return delivery.finish();
}

}  // namespace

Result<void> ChunkStore::fill(const Pass& own, uint64_t points, const MemoryPlan& memory, Ranks& ranks,
                              bool resumable, std::optional<CountGrid> counted, uint64_t first_has) {
    if (!counted) {
        LUCARNE_ASSIGN(counted, count(own, {}, points, memory));
    }
    const uint32_t stride = schema_.stride;
    std::vector<uint64_t> mine(counted->counts().begin(), counted->counts().end());
    LUCARNE_TRY(ranks.sum(counted->counts()));
    auto chunks = counted->plan(memory.chunk_points, most_chunks(memory, stride));
    const auto counts = counted->by_chunk(mine, chunks.size());
    std::vector<uint64_t>().swap(mine);
    std::vector<uint64_t> weights;
    for (const Chunk& chunk : chunks) weights.push_back(chunk.count);
    if (std::accumulate(weights.begin(), weights.end(), uint64_t{0}) != points) return inputs_changed();
    const auto first_of_rank = divide(weights, ranks.count(), first_has);
    LUCARNE_ASSIGN(auto lanes, plan_lanes(ranks, counts, first_of_rank));
    {
        Delivery delivery(
            ranks, file_, schema_, root_, [&](const Place& place) { return counted->chunk_of(place); },
            first_of_rank, std::move(lanes), memory.buffer_bytes);
        LUCARNE_TRY(deliver(ranks, own, delivery));
    }
    counted.reset();
    const auto at = [&](size_t rank) { return chunks.begin() + static_cast<ptrdiff_t>(first_of_rank[rank]); };
    std::vector<Chunk> coarse(at(ranks.rank()), at(ranks.rank() + 1));
    for (Chunk& chunk : coarse) {
        chunk.first = end_;
        end_ += chunk.count;
        if (!resumable) continue;
        chunk.piece = kSummed;
        LUCARNE_ASSIGN(chunk.sum, sum_of(chunk));
    }
    LUCARNE_TRY(refine(std::move(coarse), memory));
    return learn_others(ranks);
}

Result<void> ChunkStore::fill(const Given& given, const GivenCubes& cubes, const MemoryPlan& memory,
                              Ranks& ranks) {
    const size_t first = given.first_of_rank[ranks.rank()], end = given.first_of_rank[ranks.rank() + 1];
    LUCARNE_ASSIGN(const auto found, count_in(cubes, given.present));
    const auto present = std::span(found).subspan(first, end - first);
    LUCARNE_ASSIGN(auto lanes, plan_lanes(ranks, given.counts, given.first_of_rank, present));
    std::vector<Chunk> chunks;
    for (size_t cube = first; cube < end; ++cube) {
        const uint64_t count = present[cube - first];
        chunks.push_back(
            {.key = cubes.key(cube), .first = lanes[0][cube - first].next - count, .count = count});
    }
    LUCARNE_TRY(deal(given.present, cubes, first, chunks, memory));
    for (size_t i = 0; i < chunks.size(); ++i) {
        end_ = lanes.back()[i].end;
        chunks[i].count = end_ - chunks[i].first;
    }
    {
        Delivery delivery(
            ranks, file_, schema_, root_, [&](const Place& place) { return cubes.of(place); },
            given.first_of_rank, std::move(lanes), memory.buffer_bytes);
        LUCARNE_TRY(deliver(ranks, given.added, delivery));
    }
    std::erase_if(chunks, [](const Chunk& chunk) { return chunk.count == 0; });
    LUCARNE_TRY(refine(std::move(chunks), memory));
    return learn_others(ranks);
}

/// Puts the chunks of the other ranks before and behind the own ones.
Result<void> ChunkStore::learn_others(Ranks& ranks) {
    LUCARNE_ASSIGN(const auto all, share(ranks, as_parcel(std::span<const Chunk>(chunks_))));
    chunks_.clear();
    first_of_rank_ = {0};
    for (const Bytes& list : all) {
        const auto part = from_parcel<Chunk>(list);
        chunks_.insert(chunks_.end(), part.begin(), part.end());
        first_of_rank_.push_back(chunks_.size());
    }
    own_ = ChunkRange{first_of_rank_[ranks.rank()], first_of_rank_[ranks.rank() + 1]};
    return {};
}

}  // namespace lucarne::octree
