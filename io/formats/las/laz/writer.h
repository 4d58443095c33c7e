#pragma once

#include "io/files/file.h"
#include "io/formats/las/laz/chunk_table.h"

namespace lucarne::io::laz {

inline constexpr uint32_t kUsualChunk = 50'000;  ///< points; the same as LASzip's
/// Returns how new files are compressed: point formats 0 to 3 point by point (item version 2, which LASzip 2
/// reads as well), 6 to 8 in layers (item version 3).
Compression usual_compression(const las::Header& header, uint32_t chunk_points = kUsualChunk);
/// Returns the record that describes the compression.
las::Vlr compression_record(const Compression& compression);

/// Writes the points of a LAZ file after the current content of the file: the offset of the chunk table, the
/// chunks, which are encoded in parallel, and the table.
class PointsWriter {
 public:
    PointsWriter(OutputFile& file, Compression compression, uint16_t record_bytes);

    Result<void> begin();
    Result<void> write(std::span<const std::byte> records);
    /// Ends a chunk. Only with kVariableChunks.
    Result<void> end_chunk();
    Result<void> finish();
    /// Returns all chunks, once the writer is finished.
    const std::vector<ChunkPlace>& chunks() const { return chunks_; }

 private:
    void cut(size_t end);
    Result<void> flush();

    OutputFile& file_;
    Compression compression_;
    uint16_t record_bytes_;
    uint64_t begin_ = 0;
    std::vector<std::byte> waiting_;
    std::vector<size_t> ends_;  ///< ends of the chunks within waiting_
    std::vector<ChunkPlace> chunks_;
};

}  // namespace lucarne::io::laz
