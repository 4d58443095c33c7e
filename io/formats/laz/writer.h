#pragma once

#include "io/core/file.h"
#include "io/formats/laz/record.h"

namespace lucarne::io::laz {

/// Compression of point formats 6 to 8 in layers, and the record that says so.
Compression layered_compression(const las::Header& header);
las::Vlr compression_record(const Compression& compression);

/// The points of a LAZ file, written behind what the file holds when it is made: the place of the chunk
/// table, chunks of 50 000 points, encoded side by side, and the table.
class PointsWriter {
 public:
    PointsWriter(OutputFile& file, Compression compression, uint16_t record_bytes);

    Result<void> begin();
    Result<void> write(std::span<const std::byte> records);
    Result<void> finish();

 private:
    Result<void> flush(bool all);

    OutputFile& file_;
    Compression compression_;
    uint16_t record_bytes_;
    uint64_t begin_ = 0;
    std::vector<std::byte> waiting_;
    std::vector<uint32_t> chunk_bytes_;
};

}  // namespace lucarne::io::laz
