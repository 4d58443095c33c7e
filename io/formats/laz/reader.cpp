#include "io/formats/laz/reader.h"

#include <algorithm>
#include <optional>
#include <thread>

#include "io/core/parallel.h"
#include "io/formats/format.h"
#include "io/formats/las_layout.h"
#include "io/formats/laz/chunk_decoder.h"

namespace lucarne::io::laz {
namespace {

constexpr uint64_t kMostReadyBytes = kLargestBatch / 2;
constexpr uint64_t kPiecePoints = 1024;  ///< decoded before they are unpacked, while they are in the cache

/// A chunk's bytes, and how far it has been decoded.
struct OpenChunk {
    std::vector<std::byte> bytes;
    std::optional<ChunkDecoder> decoder;
    uint64_t left = 0;
};

Result<OpenChunk> open_chunk(const Points& points, size_t index) {
    const ChunkPlace& place = points.chunks[index];
    OpenChunk chunk;
    chunk.bytes.resize(place.bytes);
    LUCARNE_TRY(points.file->read_at(place.offset, chunk.bytes));
    LUCARNE_ASSIGN(chunk.decoder, ChunkDecoder::create(points.file->path().string(), points.compression,
                                                       place.points, chunk.bytes));
    chunk.left = place.points;
    return chunk;
}

/// The next `count` points of an open chunk, in records of the schema.
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
    return {};
}

class Reader final : public PointReader {
 public:
    Reader(const Points& points, const Schema& schema)
        : points_(points),
          schema_(schema),
          side_by_side_(std::max(1u, std::thread::hardware_concurrency())) {}

    Result<size_t> read(PointBatch& batch, size_t most) override {
        if (taken_ == ready_.size()) LUCARNE_TRY(fill());
        const size_t count = std::min(batch_limit(schema_, most), (ready_.size() - taken_) / schema_.stride);
        const auto from = ready_.begin() + static_cast<std::ptrdiff_t>(taken_);
        batch.bytes.assign(from, from + static_cast<std::ptrdiff_t>(count * schema_.stride));
        batch.count = count;
        taken_ += count * schema_.stride;
        return count;
    }
    uint64_t dropped() const override { return 0; }

 private:
    uint64_t most_ready() const { return std::max<uint64_t>(1, kMostReadyBytes / schema_.stride); }

    Result<void> fill() {
        taken_ = 0;
        ready_.clear();
        if (!large_.decoder && next_ < points_.chunks.size() && points_.chunks[next_].points > most_ready()) {
            LUCARNE_ASSIGN(large_, open_chunk(points_, next_++));
        }
        return large_.decoder ? fill_from_large() : fill_side_by_side();
    }

    Result<void> fill_from_large() {
        const uint64_t count = std::min(large_.left, most_ready());
        ready_.resize(count * schema_.stride);
        LUCARNE_TRY(unpack(points_, schema_, large_, count, ready_.data()));
        if (large_.left == 0) large_ = {};
        return {};
    }

    Result<void> fill_side_by_side() {
        const size_t first = next_;
        std::vector<uint64_t> begins;
        uint64_t count = 0;
        for (; next_ < points_.chunks.size() && begins.size() < 4 * size_t{side_by_side_}; ++next_) {
            const uint64_t more = points_.chunks[next_].points;
            if (count + more > most_ready()) break;
            begins.push_back(count);
            count += more;
        }
        ready_.resize(count * schema_.stride);
        FirstError error;
        parallel_ranges(begins.size(), 1, [&](size_t begin, size_t end) {
            for (size_t i = begin; i < end; ++i) {
                auto chunk = open_chunk(points_, first + i);
                Result<void> done;
                if (chunk)
                    done = unpack(points_, schema_, *chunk, chunk->left,
                                  ready_.data() + begins[i] * schema_.stride);
                else
                    done = tl::unexpected(chunk.error());
                if (!done) error.report(i, std::move(done).error());
            }
        });
        return error.result();
    }

    const Points& points_;
    const Schema& schema_;
    unsigned side_by_side_;
    size_t next_ = 0;  ///< chunk
    OpenChunk large_;
    std::vector<std::byte> ready_;
    size_t taken_ = 0;
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
    return std::make_unique<Reader>(points, schema);
}

}  // namespace lucarne::io::laz
