#include "io/formats/laz/chunk_table.h"

#include <algorithm>

#include <fmt/format.h>

#include "io/core/log.h"
#include "io/formats/laz/chunk_decoder.h"
#include "io/formats/laz/decoder.h"
#include "io/formats/laz/integers.h"

namespace lucarne::io::laz {
namespace {

constexpr uint64_t kOffsetBytes = 8;  ///< where the table begins: a number before the first chunk
constexpr uint64_t kTableHeader = 8;
/// A chunk is held in memory while it is decoded.
constexpr uint64_t kMostChunkBytes = uint64_t{1} << 30;
/// Of a record as it is, to its longest code: a symbol of a byte takes 15 bits at most, and what is not worth
/// a model goes plainly.
constexpr uint64_t kLongestCode = 4;

/// Reads at most what is there.
Result<std::vector<std::byte>> read_up_to(const InputFile& file, uint64_t offset, uint64_t bytes) {
    std::vector<std::byte> data(std::min(bytes, file.size() - std::min(offset, file.size())));
    LUCARNE_TRY(file.read_at(offset, data));
    return data;
}

/// 0 where no table can be: the number before the points, or the last of the file where a writer could not go
/// back.
Result<uint64_t> table_offset(const InputFile& file, uint64_t points_offset) {
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

/// Empty where the table is none of this file.
Result<std::vector<ChunkPlace>> parse_table(const InputFile& file, const las::Header& header,
                                            const Compression& compression, uint64_t table) {
    std::array<std::byte, kTableHeader> head{};
    LUCARNE_TRY(file.read_at(table, head));
    const uint64_t count = load<uint32_t>(&head[4]);
    const uint64_t first = header.points_offset + kOffsetBytes;
    if (load<uint32_t>(&head[0]) != 0 || count > (table - first) / header.record_length)
        return std::vector<ChunkPlace>();
    // Two numbers a chunk, each of six bytes in its longest code.
    LUCARNE_ASSIGN(const auto bytes, read_up_to(file, table + kTableHeader, 12 * count + 16));
    Decoder decoder(bytes);
    IntegerModel model(32, 2);
    const bool variable = compression.chunk_points == kVariableChunks;
    std::vector<ChunkPlace> chunks;
    uint64_t offset = first, points = 0;
    int32_t last_points = 0, last_bytes = 0;
    for (uint64_t i = 0; i < count && points < header.points; ++i) {
        if (variable) last_points = model.code(decoder, last_points, 0, 0);
        last_bytes = model.code(decoder, last_bytes, 0, 1);
        ChunkPlace chunk{offset, static_cast<uint32_t>(last_bytes),
                         variable ? static_cast<uint32_t>(last_points) : compression.chunk_points};
        chunk.points = std::min(chunk.points, header.points - points);
        if (decoder.failed() || chunk.bytes > table - offset) return std::vector<ChunkPlace>();
        points += chunk.points;
        offset += chunk.bytes;
        if (chunk.points > 0) chunks.push_back(chunk);
    }
    if (points != header.points) chunks.clear();
    return chunks;
}

/// Chunk after chunk, decoding what does not say how long it is.
Result<std::vector<ChunkPlace>> walk(const InputFile& file, const las::Header& header,
                                     const Compression& compression) {
    const std::string name = file.path().string();
    if (compression.chunk_points == kVariableChunks)
        return rejected(name, "has chunks of any size and no chunk table that says which");
    if (compression.chunked) log::warn("{}: has no chunk table; its points are looked through first", name);
    std::vector<ChunkPlace> chunks;
    std::vector<std::byte> records;
    uint64_t offset = header.points_offset + (compression.chunked ? kOffsetBytes : 0);
    for (uint64_t done = 0; done < header.points;) {
        ChunkPlace chunk{offset, 0, header.points - done};
        if (compression.chunked) chunk.points = std::min<uint64_t>(chunk.points, compression.chunk_points);
        const uint64_t longest = std::min(file.size() - std::min(offset, file.size()),
                                          kLongestCode * chunk.points * header.record_length + 1024);
        if (!compression.chunked) {
            chunk.bytes = longest;
        } else {
            if (longest > kMostChunkBytes)
                return rejected(name,
                                fmt::format("has a chunk of {} points, too large to be read", chunk.points));
            LUCARNE_ASSIGN(const auto bytes, read_up_to(file, offset, longest));
            LUCARNE_ASSIGN(auto decoder, ChunkDecoder::create(name, compression, chunk.points, bytes));
            records.resize(std::min<uint64_t>(chunk.points, 1000) * header.record_length);
            for (uint64_t left = chunk.points; left > 0;) {
                const uint64_t part = std::min<uint64_t>(left, 1000);
                LUCARNE_TRY(decoder.decode(part, records.data()));
                left -= part;
            }
            chunk.bytes = decoder.consumed();
        }
        chunks.push_back(chunk);
        done += chunk.points;
        offset += chunk.bytes;
    }
    return chunks;
}

}  // namespace

Result<std::vector<ChunkPlace>> read_chunks(const InputFile& file, const las::Header& header,
                                            const Compression& compression) {
    if (header.points == 0) return std::vector<ChunkPlace>();
    std::vector<ChunkPlace> chunks;
    if (compression.chunked) {
        LUCARNE_ASSIGN(const uint64_t table, table_offset(file, header.points_offset));
        if (table) {
            LUCARNE_ASSIGN(chunks, parse_table(file, header, compression, table));
        }
    }
    if (chunks.empty()) {
        LUCARNE_ASSIGN(chunks, walk(file, header, compression));
    }
    for (const ChunkPlace& chunk : chunks)
        if (chunk.bytes > kMostChunkBytes)
            return rejected(file.path().string(),
                            fmt::format("has a chunk of {} bytes, too large to be read", chunk.bytes));
    return chunks;
}

}  // namespace lucarne::io::laz
