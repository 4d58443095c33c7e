#pragma once

#include "io/files/file.h"
#include "io/formats/las/laz/chunk_table.h"

namespace lucarne::io::laz {

inline constexpr uint32_t kUsualChunk = 50'000;  ///< points; LASzip's own
/// How a file is compressed: point formats 0 to 3 point by point (item version 2, which LASzip 2 reads as
/// well), 6 to 8 in layers (item version 3).
Compression usual_compression(const las::Header& header, uint32_t chunk_points = kUsualChunk);
/// The record that says so.
las::Vlr compression_record(const Compression& compression);

/// The points of a LAZ file, written behind what the file holds when it is made: the place of the chunk
/// table, chunks, encoded side by side, and the table.
class PointsWriter {
 public:
    PointsWriter(OutputFile& file, Compression compression, uint16_t record_bytes);

    Result<void> begin();
    Result<void> write(std::span<const std::byte> records);
    /// What was written since the last chunk is one: where the compression has kVariableChunks.
    Result<void> end_chunk();
    Result<void> finish();
    /// All of them, once it is finished.
    const std::vector<ChunkPlace>& chunks() const { return chunks_; }

 private:
    void cut(size_t end);
    Result<void> flush();

    OutputFile& file_;
    Compression compression_;
    uint16_t record_bytes_;
    uint64_t begin_ = 0;
    std::vector<std::byte> waiting_;
    std::vector<size_t> ends_;  ///< of the chunks in what waits
    std::vector<ChunkPlace> chunks_;
};

}  // namespace lucarne::io::laz
