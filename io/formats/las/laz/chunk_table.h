#pragma once

#include <vector>

#include "io/formats/las/laz/record.h"

namespace lucarne::io::laz {

struct ChunkPlace {
    uint64_t offset = 0, bytes = 0;  ///< in the file
    uint64_t points = 0;             ///< that it holds
    uint64_t left_out = 0;           ///< of these, at its end: the header does not count them
    uint64_t taken() const { return points - left_out; }
};

/// Finds the chunks of a file from its chunk table, wherever a writer left it. Without a table, a point-wise
/// file is one stream: only a walk from its start finds the chunks, and the `bytes` of each then reach to the
/// end of the points. The chunks take the number of points in the header. How many the last point-wise chunk
/// holds is known only when it is decoded; `points` is then the header's rest. Errors: a table that does not
/// fit the file, fewer points than the header promises.
///
/// With `salvage` the chunks take what they hold, whatever the header promises. These are then no errors:
/// chunks that are cut off or damaged, and later chunks to which no table leads. The last chunk may be cut
/// off.
Result<std::vector<ChunkPlace>> read_chunks(const ByteSource& file, const las::Header& header,
                                            const Compression& compression, bool salvage = false);

/// Returns an upper limit for the end of the chunks: the beginning of the chunk table if there may be one,
/// otherwise the end of the file.
Result<uint64_t> end_of_chunks(const ByteSource& file, const las::Header& header);

}  // namespace lucarne::io::laz
