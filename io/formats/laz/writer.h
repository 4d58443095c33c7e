#pragma once

#include "io/core/file.h"
#include "io/formats/laz/chunk_table.h"

namespace lucarne::io::laz {

/// Compression of point formats 6 to 8 in layers, and the record that says so.
inline constexpr uint32_t kUsualChunk = 50'000;  ///< points; LASzip's own
Compression layered_compression(const las::Header& header, uint32_t chunk_points = kUsualChunk);
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
