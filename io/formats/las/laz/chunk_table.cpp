#include "io/formats/las/laz/chunk_table.h"

#include <algorithm>

#include <fmt/format.h>

#include "io/core/log.h"
#include "io/formats/las/bounds.h"
#include "io/formats/las/laz/chunk_decoder.h"
#include "io/formats/las/laz/decoder.h"
#include "io/formats/las/laz/integers.h"

namespace lucarne::io::laz {
namespace {

constexpr uint64_t kOffsetBytes = 8;  ///< a number before the first chunk: where the table begins
constexpr uint64_t kTableHeader = 8;
/// A larger chunk is rejected, because a chunk is held in memory while it is decoded.
constexpr uint64_t kMostChunkBytes = uint64_t{1} << 30;
/// Ratio of a record's longest code to the record: the symbol of a byte takes at most 15 bits, and values
/// without a model are stored plainly.
constexpr uint64_t kLongestCode = 4;

/// Reads `bytes` bytes, or fewer at the end of the file.
Result<std::vector<std::byte>> read_up_to(const ByteSource& file, uint64_t offset, uint64_t bytes) {
    std::vector<std::byte> data(std::min(bytes, file.size() - std::min(offset, file.size())));
    LUCARNE_TRY(file.read_at(offset, data));
    return data;
}

/// Returns where the table begins; 0 if there can be none. The offset stands before the points, or at the end
/// of the file if the writer could not go back.
Result<uint64_t> table_offset(const ByteSource& file, uint64_t points_offset) {
    const uint64_t first = points_offset + kOffsetBytes;
    if (file.size() < first + kTableHeader) return 0;
    for (const uint64_t place : {points_offset, file.size() - kOffsetBytes}) {
        std::array<std::byte, kOffsetBytes> bytes{};
        LUCARNE_TRY(file.read_at(place, bytes));
        const auto offset = load<uint64_t>(bytes.data());
        if (offset >= first && offset <= file.size() - kTableHeader) return offset;
    }
    return 0;
}

struct Table {
    std::vector<ChunkPlace> chunks;
    bool exact = false;  ///< the chunks reach exactly from the first place to the table
};

/// Reads the table. Empty if it does not belong to this file. In chunks of fixed size the last one has that
/// size, too.
Result<Table> parse_table(const ByteSource& file, const las::Header& header, const Compression& compression,
                          uint64_t table) {
    std::array<std::byte, kTableHeader> head{};
    LUCARNE_TRY(file.read_at(table, head));
    const uint64_t count = load<uint32_t>(&head[4]);
    const uint64_t first = header.points_offset + kOffsetBytes;
    if (load<uint32_t>(&head[0]) != 0 || count > (table - first) / header.record_length) return Table();
    // Each chunk takes two numbers, whose longest code is six bytes.
    LUCARNE_ASSIGN(const auto bytes, read_up_to(file, table + kTableHeader, 12 * count + 16));
    Decoder decoder(bytes);
    IntegerModel model(32, 2);
    const bool variable = compression.chunk_points == kVariableChunks;
    Table result;
    uint64_t offset = first;
    int32_t last_points = 0, last_bytes = 0;
    for (uint64_t i = 0; i < count; ++i) {
        if (variable) last_points = model.code(decoder, last_points, 0, 0);
        last_bytes = model.code(decoder, last_bytes, 0, 1);
        const ChunkPlace chunk{offset, static_cast<uint32_t>(last_bytes),
                               variable ? static_cast<uint32_t>(last_points) : compression.chunk_points};
        if (decoder.failed() || chunk.bytes > table - offset) return Table();
        offset += chunk.bytes;
        if (chunk.points > 0 && chunk.bytes >= header.record_length) result.chunks.push_back(chunk);
    }
    result.exact = offset == table;
    return result;
}

/// Fits the chunks of a table to what the header promises, or with `salvage` to what they hold.
class Settlement {
 public:
    Settlement(const ByteSource& file, const las::Header& header, const Compression& compression,
               bool salvage)
        : file_(file),
          header_(header),
          compression_(compression),
          salvage_(salvage),
          name_(file.path().string()) {}

    /// Returns the chunks; none if the table does not belong to the file.
    Result<std::vector<ChunkPlace>> settle(Table table) const {
        std::vector<ChunkPlace>& chunks = table.chunks;
        if (chunks.empty()) return chunks;
        if (compression_.chunk_points != kVariableChunks) LUCARNE_TRY(count_last(table));
        uint64_t points = 0;
        for (const ChunkPlace& chunk : chunks) points += chunk.points;
        const bool equal = points == header_.points;
        if (!equal && !table.exact) return std::vector<ChunkPlace>();
        for (const ChunkPlace& chunk : chunks)
            if (chunk.points / las::kMostPointsAByte > chunk.bytes) return std::vector<ChunkPlace>();
        if (equal || salvage_) {
            if (!equal && las::too_many_for(file_.size(), points, header_.record_length))
                return rejected(name_, fmt::format("has chunks of {} points, more than its {} bytes can hold",
                                                   points, file_.size()));
            return std::move(chunks);
        }
        if (points < header_.points)
            return rejected(name_, fmt::format("its header promises {} points, its chunks hold {}",
                                               header_.points, points));
        uint64_t counted = 0;
        for (ChunkPlace& chunk : chunks) {
            chunk.left_out = chunk.points - std::min(chunk.points, header_.points - counted);
            counted += chunk.taken();
        }
        return std::move(chunks);
    }

 private:
    /// Finds out how many points the last chunk has, where all have the same number but the last.
    Result<void> count_last(Table& table) const {
        ChunkPlace& last = table.chunks.back();
        const uint64_t before = last.points * (table.chunks.size() - 1);
        if (compression_.layered) {
            LUCARNE_ASSIGN(const auto head, read_up_to(file_, last.offset, layered_head_bytes(compression_)));
            const auto size = layered_size(name_, compression_, head);
            if (size && size->points > 0 && size->points <= last.points) last.points = size->points;
            return {};
        }
        const bool plausible = header_.points > before && header_.points - before <= last.points;
        const uint64_t expected = plausible ? header_.points - before : 0;
        if ((salvage_ || !plausible) && table.exact && last.bytes <= kMostChunkBytes) {
            LUCARNE_ASSIGN(const auto bytes, read_up_to(file_, last.offset, last.bytes));
            const uint64_t most = std::min(last.points, bytes.size() * las::kMostPointsAByte);
            const auto found = count_points(compression_, bytes, most, expected);
            if (found) last.points = *found;
            if (found) return {};
        }
        if (plausible) last.points = expected;
        return {};
    }

    const ByteSource& file_;
    const las::Header& header_;
    const Compression& compression_;
    bool salvage_;
    std::string name_;
};

/// Walks from chunk to chunk without a table. Layered chunks state their size; others must be decoded.
class Walk {
 public:
    Walk(const ByteSource& file, const las::Header& header, const Compression& compression)
        : file_(file),
          header_(header),
          compression_(compression),
          bounds_(header),
          name_(file.path().string()) {}

    Result<std::vector<ChunkPlace>> go(bool salvage) {
        if (compression_.chunk_points == kVariableChunks && !compression_.layered)
            return rejected(name_, "has chunks of variable size, but no chunk table");
        if (compression_.chunked)
            log::warn("{}: has no chunk table; its chunks are searched for first", name_);
        std::vector<ChunkPlace> chunks;
        uint64_t offset = header_.points_offset + (compression_.chunked ? kOffsetBytes : 0);
        for (uint64_t done = 0; done < header_.points;) {
            ChunkPlace chunk{offset, 0, header_.points - done};
            if (compression_.chunked)
                chunk.points = std::min<uint64_t>(chunk.points, compression_.chunk_points);
            auto measured = measure(chunk);
            const bool sound = measured.has_value();
            if (!sound && (!salvage || measured.error().kind != ErrorKind::input_rejected))
                return tl::unexpected(std::move(measured).error());
            // In a point-wise chunk, the points before the cut can be read.
            if (sound || (!compression_.layered && chunk.bytes > 0)) chunks.push_back(chunk);
            if (!sound) break;
            done += chunk.points;
            offset += chunk.bytes;
        }
        return chunks;
    }

 private:
    /// Finds the chunk's size. If the chunk is damaged, sets it to the bytes up to the end of the file.
    Result<void> measure(ChunkPlace& chunk) const {
        if (compression_.layered) return measure_layers(chunk);
        const uint64_t left = file_.size() - std::min(chunk.offset, file_.size());
        chunk.bytes = std::min(left, kLongestCode * chunk.points * header_.record_length + 1024);
        if (!compression_.chunked) return {};
        if (chunk.bytes > kMostChunkBytes)
            return rejected(name_,
                            fmt::format("has a chunk of {} points, too large to be read", chunk.points));
        // Most chunks shrink to less than half, so the longest possible chunk is read only if needed.
        for (uint64_t some = chunk.points * header_.record_length / 2 + 4096;; some *= 4) {
            const uint64_t bytes = std::min(some, chunk.bytes);
            auto used = decode_all(chunk, bytes);
            if (!used && bytes < chunk.bytes && used.error().kind == ErrorKind::input_rejected) continue;
            LUCARNE_ASSIGN(chunk.bytes, std::move(used));
            return {};
        }
    }

    /// Decodes the chunk and returns how many of the bytes it takes. Bytes of something else decode as well,
    /// but to places far outside the scan, for which they are rejected.
    Result<uint64_t> decode_all(const ChunkPlace& chunk, uint64_t most_bytes) const {
        LUCARNE_ASSIGN(const auto bytes, read_up_to(file_, chunk.offset, most_bytes));
        LUCARNE_ASSIGN(auto decoder, ChunkDecoder::create(name_, compression_, chunk.points, bytes));
        std::vector<std::byte> records(std::min<uint64_t>(chunk.points, 1000) * header_.record_length);
        for (uint64_t to_go = chunk.points; to_go > 0;) {
            const uint64_t part = std::min<uint64_t>(to_go, 1000);
            LUCARNE_TRY(decoder.decode(part, records.data()));
            if (bounds_.outside(records.data(), part, header_.record_length))
                return rejected(name_, "has compressed points that are damaged");
            to_go -= part;
        }
        return decoder.consumed();
    }

    Result<void> measure_layers(ChunkPlace& chunk) const {
        LUCARNE_ASSIGN(const auto head, read_up_to(file_, chunk.offset, layered_head_bytes(compression_)));
        LUCARNE_ASSIGN(const auto size, layered_size(name_, compression_, head));
        const bool variable = compression_.chunk_points == kVariableChunks;
        if (size.points == 0 || size.points > chunk.points || (!variable && size.points != chunk.points))
            return rejected(name_, "has a chunk with an impossible number of points");
        if (size.bytes > file_.size() - chunk.offset)
            return rejected(name_, "has compressed points that are cut off or damaged");
        chunk.points = size.points;
        chunk.bytes = size.bytes;
        return {};
    }

    const ByteSource& file_;
    const las::Header& header_;
    const Compression& compression_;
    las::StatedBounds bounds_;
    std::string name_;
};

}  // namespace

Result<uint64_t> end_of_chunks(const ByteSource& file, const las::Header& header) {
    LUCARNE_ASSIGN(const uint64_t table, table_offset(file, header.points_offset));
    return table ? table : file.size();
}

Result<std::vector<ChunkPlace>> read_chunks(const ByteSource& file, const las::Header& header,
                                            const Compression& compression, bool salvage) {
    if (header.points == 0 && !salvage) return std::vector<ChunkPlace>();
    std::vector<ChunkPlace> chunks;
    if (compression.chunked) {
        LUCARNE_ASSIGN(const uint64_t table, table_offset(file, header.points_offset));
        if (table) {
            LUCARNE_ASSIGN(Table found, parse_table(file, header, compression, table));
            LUCARNE_ASSIGN(chunks, Settlement(file, header, compression, salvage).settle(std::move(found)));
        }
    }
    if (chunks.empty() && header.points > 0) {
        LUCARNE_ASSIGN(chunks, Walk(file, header, compression).go(salvage));
    }
    for (const ChunkPlace& chunk : chunks)
        if (chunk.bytes > kMostChunkBytes)
            return rejected(file.path().string(),
                            fmt::format("has a chunk of {} bytes, too large to be read", chunk.bytes));
    return chunks;
}

}  // namespace lucarne::io::laz
