#pragma once

#include <vector>

#include "io/formats/las/laz/record.h"

namespace lucarne::io::laz {

struct ChunkPlace {
    uint64_t offset = 0, bytes = 0;  ///< in the file
    uint64_t points = 0;
};

/// Where the chunks of a file are: from its chunk table, wherever a writer left it. Where there is none,
/// point-wise files are one stream that only a walk from the start divides: `bytes` of each then reaches to
/// the end of the points. Errors: tables that do not fit the file or its number of points. With `salvage`
/// chunks that are cut off or damaged, and those behind them that no table leads to, are no error: the chunks
/// may then hold fewer points than the header promises, and the last of them may be cut off.
Result<std::vector<ChunkPlace>> read_chunks(const ByteSource& file, const las::Header& header,
                                            const Compression& compression, bool salvage = false);

/// Where chunks end at the latest: where the chunk table begins, if there may be one, else with the file.
Result<uint64_t> end_of_chunks(const ByteSource& file, const las::Header& header);

}  // namespace lucarne::io::laz
