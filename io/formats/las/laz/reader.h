#pragma once

#include <memory>

#include "io/formats/las/laz/chunk_table.h"

namespace lucarne::io::laz {

/// The points of a LAZ file: everything that is needed to decode any of its chunks.
struct Points {
    std::shared_ptr<const ByteSource> file;
    las::Header header;
    Compression compression;
    std::vector<ChunkPlace> chunks;
    bool salvage = false;  ///< a damaged chunk is a loss and not an error
};

/// Decodes the first `count` points of chunk number `index`, or all if it has fewer, to records of a LAS
/// file.
Result<std::vector<std::byte>> decode_chunk(const Points& points, size_t index, uint64_t count);

/// Decodes all points of chunk number `index` to records of las::make_schema.
Result<std::vector<std::byte>> read_chunk(const Points& points, size_t index, const Schema& schema);

/// Starts a pass over the points, as records of las::make_schema. Several chunks are decoded in parallel.
/// `points` and `schema` must outlive the reader.
std::unique_ptr<PointReader> open_points(const Points& points, const Schema& schema);
/// The same for the chunks [first, end).
std::unique_ptr<PointReader> open_points(const Points& points, const Schema& schema, size_t first,
                                         size_t end);

/// Where a chunk begins.
struct ChunkBegin {
    size_t chunk = 0;
    uint64_t point = 0;
};
/// Returns the last beginning of a chunk at `point` or before it, or the end of the last chunk. Where it is
/// not known how many points each chunk gives, only the first beginning and the end are known.
ChunkBegin chunk_begin(const Points& points, uint64_t point);

}  // namespace lucarne::io::laz
