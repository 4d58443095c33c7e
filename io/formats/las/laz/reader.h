#pragma once

#include <memory>

#include "io/formats/las/laz/chunk_table.h"

namespace lucarne::io::laz {

/// A LAZ file's points: what is needed to decode any of its chunks.
struct Points {
    std::shared_ptr<const ByteSource> file;
    las::Header header;
    Compression compression;
    std::vector<ChunkPlace> chunks;
    bool salvage = false;  ///< a chunk that is damaged is a loss and no error
};

/// The first `count` points of chunk number `index`, or all it has, as records of a LAS file.
Result<std::vector<std::byte>> decode_chunk(const Points& points, size_t index, uint64_t count);

/// All points of chunk number `index`, in the records of las::make_schema.
Result<std::vector<std::byte>> read_chunk(const Points& points, size_t index, const Schema& schema);

/// One pass over the points, in the records of las::make_schema; several chunks are decoded side by side.
/// Both outlive the reader.
std::unique_ptr<PointReader> open_points(const Points& points, const Schema& schema);

}  // namespace lucarne::io::laz
