#include "io/formats/las/laz/reader.h"

#include <algorithm>
#include <optional>

#include "io/core/parallel.h"
#include "io/formats/common/format.h"
#include "io/formats/las/bounds.h"
#include "io/formats/las/layout.h"
#include "io/formats/las/laz/chunk_decoder.h"

namespace lucarne::io::laz {
namespace {

constexpr uint64_t kMostReadyBytes = kLargestBatch / 2;
constexpr uint64_t kPiecePoints = 1024;  ///< decoded at a time, and unpacked while they are in the cache

/// A chunk's bytes, and how far they have been decoded.
struct OpenChunk {
    std::vector<std::byte> bytes;
    std::optional<ChunkDecoder> decoder;
    uint64_t points = 0, left = 0;  ///< to be read
    uint64_t left_out = 0;          ///< after these
    bool checked = false;           ///< the code must end where the chunk does
    bool last = false;
    uint64_t uncounted = 0;  ///< points after the last that the header counts, once that is decoded
};

Result<OpenChunk> open_chunk(const Points& points, size_t index, uint64_t most_bytes = UINT64_MAX) {
    const ChunkPlace& place = points.chunks[index];
    OpenChunk chunk;
    chunk.bytes.resize(std::min(place.bytes, most_bytes));
    LUCARNE_TRY(points.file->read_at(place.offset, chunk.bytes));
    LUCARNE_ASSIGN(chunk.decoder, ChunkDecoder::create(points.file->path().string(), points.compression,
                                                       place.points, chunk.bytes));
    chunk.points = chunk.left = place.taken();
    chunk.last = index + 1 == points.chunks.size();
    chunk.left_out = place.left_out;
    chunk.checked = points.compression.chunked && place.taken() > 0;
    return chunk;
}

bool ends_with_file(const Points& points, size_t index) {
    return points.chunks[index].offset + points.chunks[index].bytes >= points.file->size();
}

/// Checks after the last point that is read that the code ends where the chunk does.
Result<void> check_end(const Points& points, OpenChunk& chunk) {
    if (!chunk.checked) return {};
    const bool all = chunk.left_out == 0;
    std::vector<std::byte> raw(std::min(chunk.left_out, kPiecePoints) * points.header.record_length);
    while (chunk.left_out > 0) {
        const uint64_t piece = std::min(chunk.left_out, kPiecePoints);
        LUCARNE_TRY(chunk.decoder->decode(piece, raw.data()));
        chunk.left_out -= piece;
    }
    if (chunk.decoder->ends_well()) return {};
    // The number of points in the last chunk follows from the header, which may count too few.
    if (all && chunk.last && points.compression.chunk_points != kVariableChunks) {
        const uint64_t most =
            std::min<uint64_t>(points.compression.chunk_points, chunk.bytes.size() * las::kMostPointsAByte);
        const auto there = count_points(points.compression, chunk.bytes, most, chunk.points);
        chunk.uncounted = std::max(there.value_or(0), chunk.points) - chunk.points;
        if (chunk.uncounted > 0) return {};
    }
    return rejected(points.file->path().string(), "has a chunk of compressed points that is damaged");
}

/// Decodes the next `count` points of an open chunk to records of the schema.
Result<void> unpack(const Points& points, const Schema& schema, OpenChunk& chunk, uint64_t count,
                    std::byte* to) {
    const uint32_t bytes = points.header.record_length;
    std::vector<std::byte> raw(std::min(count, kPiecePoints) * bytes);
    chunk.left -= count;
    while (count > 0) {
        const uint64_t piece = std::min(count, kPiecePoints);
        LUCARNE_TRY(chunk.decoder->decode(piece, raw.data()));
        las::decode(points.header, raw.data(), piece, to, schema.stride);
        to += piece * schema.stride;
        count -= piece;
    }
    return chunk.left > 0 ? Result<void>() : check_end(points, chunk);
}

/// Returns how many points of a damaged chunk can be trusted. If the file ends within a point-wise chunk,
/// these are the points before the end; otherwise none. A chunk table behind the last point does not count as
/// points, even if the header promises more.
Result<uint64_t> sound_points(const Points& points, size_t index) {
    const ChunkPlace& place = points.chunks[index];
    if (points.compression.layered || !ends_with_file(points, index)) return 0u;
    LUCARNE_ASSIGN(const uint64_t end, end_of_chunks(*points.file, points.header));
    auto chunk = open_chunk(points, index, end > place.offset ? end - place.offset : UINT64_MAX);
    if (!chunk && chunk.error().kind == ErrorKind::input_rejected) return 0u;
    if (!chunk) return tl::unexpected(std::move(chunk).error());
    std::vector<std::byte> record(points.header.record_length);
    const las::StatedBounds bounds(points.header);
    uint64_t sound = 0;
    while (sound < place.taken() && chunk->decoder->decode(1, record.data()) &&
           !bounds.outside(record.data(), 1, record.size()))
        ++sound;
    return sound;
}

class Reader final : public PointReader {
 public:
    Reader(const Points& points, const Schema& schema, size_t first, size_t end)
        : points_(points),
          schema_(schema),
          next_(first),
          end_(end),
          side_by_side_(tbb::global_control::active_value(tbb::global_control::max_allowed_parallelism)) {}

    Result<size_t> read(PointBatch& batch, size_t most) override {
        while (taken_ == ready_.size() && (large_.decoder || next_ < end_)) LUCARNE_TRY(fill());
        const size_t count = std::min(batch_limit(schema_, most), (ready_.size() - taken_) / schema_.stride);
        const auto from = ready_.begin() + static_cast<std::ptrdiff_t>(taken_);
        batch.bytes.assign(from, from + static_cast<std::ptrdiff_t>(count * schema_.stride));
        batch.count = count;
        taken_ += count * schema_.stride;
        return count;
    }
    uint64_t dropped() const override { return 0; }
    Losses losses() const override { return losses_; }

 private:
    uint64_t most_ready() const { return std::max<uint64_t>(1, kMostReadyBytes / schema_.stride); }

    Result<void> fill() {
        taken_ = 0;
        ready_.clear();
        if (!large_.decoder && next_ < end_ && points_.chunks[next_].taken() > most_ready()) {
            return begin_large();
        }
        return large_.decoder ? fill_from_large() : fill_side_by_side();
    }

    Result<void> begin_large() {
        const size_t index = next_++;
        uint64_t sound = points_.chunks[index].taken();
        if (points_.salvage) {
            LUCARNE_ASSIGN(sound, sound_of_large(index));
            lose(index, points_.chunks[index].taken() - sound);
            if (sound == 0) return {};
        }
        LUCARNE_ASSIGN(large_, open_chunk(points_, index));
        large_.left = sound;
        return {};
    }

    /// Decodes a large chunk once to see whether it is sound, because its points are returned while it is
    /// decoded.
    Result<uint64_t> sound_of_large(size_t index) const {
        auto chunk = open_chunk(points_, index);
        Result<void> done = chunk ? Result<void>() : tl::unexpected(chunk.error());
        std::vector<std::byte> records(kPiecePoints * points_.header.record_length);
        for (uint64_t left = points_.chunks[index].taken(); done && left > 0;) {
            const uint64_t piece = std::min(left, kPiecePoints);
            done = chunk->decoder->decode(piece, records.data());
            left -= piece;
        }
        if (done) return points_.chunks[index].taken();
        if (done.error().kind != ErrorKind::input_rejected) return tl::unexpected(std::move(done).error());
        return sound_points(points_, index);
    }

    void lose(size_t index, uint64_t points) {
        add_loss(losses_, ends_with_file(points_, index) ? lost::cut_off : lost::damaged, points);
    }

    Result<void> fill_from_large() {
        const uint64_t count = std::min(large_.left, most_ready());
        ready_.resize(count * schema_.stride);
        LUCARNE_TRY(unpack(points_, schema_, large_, count, ready_.data()));
        if (large_.left > 0) return {};
        add_loss(losses_, lost::uncounted, large_.uncounted);
        large_ = {};
        return {};
    }

    Result<void> fill_side_by_side() {
        const size_t first = next_;
        std::vector<uint64_t> begins;
        uint64_t count = 0;
        for (; next_ < end_ && begins.size() < most_chunks(); ++next_) {
            const uint64_t more = points_.chunks[next_].taken();
            if (count + more > most_ready()) break;
            begins.push_back(count);
            count += more;
        }
        ready_.resize(count * schema_.stride);
        std::vector<uint64_t> kept(begins.size());
        FirstError error;
        parallel_ranges(begins.size(), 1, [&](size_t begin, size_t end) {
            for (size_t i = begin; i < end; ++i) {
                const auto sound = take_chunk(first + i, ready_.data() + begins[i] * schema_.stride);
                if (sound)
                    kept[i] = *sound;
                else
                    error.report(i, sound.error());
            }
        });
        add_loss(losses_, lost::uncounted, std::exchange(uncounted_, 0));
        if (points_.salvage) close_gaps(first, begins, kept);
        return error.result();
    }

    /// Decodes all points of a chunk, or with `salvage` the sound ones. Returns their number.
    Result<uint64_t> take_chunk(size_t index, std::byte* to) {
        const uint64_t points = points_.chunks[index].taken();
        auto done = take_points(index, points, to);
        if (done) return points;
        if (!points_.salvage || done.error().kind != ErrorKind::input_rejected)
            return tl::unexpected(std::move(done).error());
        LUCARNE_ASSIGN(const uint64_t sound, sound_points(points_, index));
        if (sound > 0) LUCARNE_TRY(take_points(index, sound, to));
        return sound;
    }
    Result<void> take_points(size_t index, uint64_t count, std::byte* to) {
        LUCARNE_ASSIGN(auto chunk, open_chunk(points_, index));
        LUCARNE_TRY(unpack(points_, schema_, chunk, count, to));
        if (chunk.last) uncounted_ = chunk.uncounted;
        return {};
    }

    /// Moves together the `kept` points of each chunk, which begin at `begins`.
    void close_gaps(size_t first, const std::vector<uint64_t>& begins, const std::vector<uint64_t>& kept) {
        size_t end = 0;
        for (size_t i = 0; i < begins.size(); ++i) {
            const size_t bytes = kept[i] * schema_.stride;
            std::memmove(ready_.data() + end, ready_.data() + begins[i] * schema_.stride, bytes);
            end += bytes;
            lose(first + i, points_.chunks[first + i].taken() - kept[i]);
        }
        ready_.resize(end);
    }

    /// Returns how many chunks may be held at once. The models of a chunk with wide records take many times
    /// the memory of the records.
    size_t most_chunks() const {
        constexpr uint64_t kModels = uint64_t{256} << 20;
        const uint64_t each = model_bytes(points_.compression);
        return std::clamp<size_t>(kModels / each, 1, side_by_side_ > 1 ? 4 * side_by_side_ : 1);
    }

    const Points& points_;
    const Schema& schema_;
    size_t next_, end_;    ///< the next chunk, and the end of this pass
    size_t side_by_side_;  ///< threads that may decode; one thread holds one chunk, several hold several each
    OpenChunk large_;
    std::vector<std::byte> ready_;
    size_t taken_ = 0;
    uint64_t uncounted_ = 0;  ///< by the header: points of the last chunk
    Losses losses_;
};

}  // namespace

Result<std::vector<std::byte>> decode_chunk(const Points& points, size_t index, uint64_t count) {
    LUCARNE_ASSIGN(auto chunk, open_chunk(points, index));
    count = std::min(count, chunk.left);
    std::vector<std::byte> records(count * points.header.record_length);
    LUCARNE_TRY(chunk.decoder->decode(count, records.data()));
    return records;
}

Result<std::vector<std::byte>> read_chunk(const Points& points, size_t index, const Schema& schema) {
    LUCARNE_ASSIGN(auto chunk, open_chunk(points, index));
    std::vector<std::byte> records(chunk.left * schema.stride);
    LUCARNE_TRY(unpack(points, schema, chunk, chunk.left, records.data()));
    return records;
}

std::unique_ptr<PointReader> open_points(const Points& points, const Schema& schema) {
    return open_points(points, schema, 0, points.chunks.size());
}
std::unique_ptr<PointReader> open_points(const Points& points, const Schema& schema, size_t first,
                                         size_t end) {
    return std::make_unique<Reader>(points, schema, first, end);
}

ChunkBegin chunk_begin(const Points& points, uint64_t point) {
    const auto& chunks = points.chunks;
    // Without a table, places and numbers of points are guesses; damaged chunks give fewer points.
    bool known = points.compression.chunked && !points.salvage;
    for (size_t i = 0; known && i + 1 < chunks.size(); ++i)
        known = chunks[i].offset + chunks[i].bytes <= chunks[i + 1].offset;
    ChunkBegin begin, found;
    for (const ChunkPlace& chunk : chunks) {
        begin = {begin.chunk + 1, begin.point + chunk.taken()};
        if (begin.point <= point && (known || begin.chunk == chunks.size())) found = begin;
    }
    return found;
}

}  // namespace lucarne::io::laz
