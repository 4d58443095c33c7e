#pragma once

#include <filesystem>
#include <limits>

#include "io/formats/las/laz/writer.h"
#include "io/formats/las/target.h"
#include "io/formats/scan.h"

namespace lucarne::io::las {

/// What a header says about the points. It is collected while they are written.
struct Statistics {
    std::array<int32_t, 3> low, high;
    std::array<uint64_t, 16> returns{};  ///< by return number
    double gps_low = std::numeric_limits<double>::infinity(), gps_high = -gps_low;

    Statistics();
    /// Adds records that begin with these fields.
    void add(const std::byte* records, size_t count, size_t stride, const Schema& fields);
};

/// Writes a LAS, LAZ or COPC file for a target.
class Writer final : public PointWriter {
 public:
    Writer(OutputFile file, std::string path, Target target, uint32_t in_stride);
    Writer(const Writer&) = delete;  // the compressor holds a reference to file_
    Writer& operator=(const Writer&) = delete;

    /// Leaves room for the header and writes the records that come before the points. For LAZ, a chunk has so
    /// many points; with laz::kVariableChunks it has the points written between two calls of end_chunk().
    Result<void> begin(uint32_t chunk_points = laz::kUsualChunk);
    Result<void> write(std::span<const std::byte> records) override;
    Result<void> end_chunk();
    /// Ends the points. Afterwards the chunks are known, and so is the place of the extended records.
    Result<void> finish_points();
    const std::vector<laz::ChunkPlace>& chunks() const { return compressed_->chunks(); }
    uint64_t position() const { return file_.position(); }
    const Statistics& statistics() const { return statistics_; }
    /// The header may be changed until finish(), but not the number and length of the records before the
    /// points.
    Header& header() { return target_.header; }
    Result<void> finish() override;

 private:
    Result<void> write_piece(const std::byte* in, size_t count);
    Result<void> flush();

    OutputFile file_;
    std::string path_;
    Target target_;
    uint32_t in_stride_;
    uint64_t points_offset_ = 0;
    bool points_done_ = false;
    std::optional<laz::PointsWriter> compressed_;
    Statistics statistics_;
    std::vector<std::byte> converted_, buffer_;
};

/// For create_scan.
Result<std::unique_ptr<PointWriter>> create(const std::filesystem::path& path, const Schema& schema,
                                            const ScanInfo& info, const WriteOptions& options);
/// For create_scan, LAZ: the same header and records, compressed.
Result<std::unique_ptr<PointWriter>> create_compressed(const std::filesystem::path& path,
                                                       const Schema& schema, const ScanInfo& info,
                                                       const WriteOptions& options);

}  // namespace lucarne::io::las
