#include "io/formats/las/laz/writer.h"

#include <algorithm>
#include <thread>

#include "io/core/parallel.h"
#include "io/formats/las/laz/chunk_encoder.h"
#include "io/formats/las/laz/encoder.h"
#include "io/formats/las/laz/integers.h"

namespace lucarne::io::laz {
namespace {

constexpr uint16_t kPointWiseItems = 2, kLayeredItems = 3;
constexpr uint8_t kMajor = 3, kMinor = 4;  ///< of the LASzip that first wrote such files

template <class T>
void put(std::vector<std::byte>& bytes, T value) {
    bytes.resize(bytes.size() + sizeof value);
    store(&bytes[bytes.size() - sizeof value], value);
}

/// Returns how many chunks are encoded in parallel.
size_t side_by_side() {
    return std::max(1u, std::thread::hardware_concurrency());
}

}  // namespace

Compression usual_compression(const las::Header& header, uint32_t chunk_points) {
    const bool layered = las::extended_format(header.point_format);
    return {true, layered, chunk_points, items_of(header, layered ? kLayeredItems : kPointWiseItems)};
}

las::Vlr compression_record(const Compression& compression) {
    las::Vlr record{std::string(kUser), kRecord, "LAZ compressed points", false, {}};
    std::vector<std::byte>& data = record.data;
    put<uint16_t>(data, compression.layered   ? kLayeredChunked
                        : compression.chunked ? kPointWiseChunked
                                              : kPointWise);
    put<uint16_t>(data, 0);  // the arithmetic coder
    put(data, kMajor);
    put(data, kMinor);
    put<uint16_t>(data, 0);  // revision
    put<uint32_t>(data, 0);  // options
    put(data, compression.chunk_points);
    put<int64_t>(data, -1);  // no special records: their number, their offset
    put<int64_t>(data, -1);
    put(data, static_cast<uint16_t>(compression.items.size()));
    for (const ItemLayout& item : compression.items) {
        put(data, static_cast<uint16_t>(item.item));
        put(data, item.bytes);
        put(data, item.version);
    }
    return record;
}

PointsWriter::PointsWriter(OutputFile& file, Compression compression, uint16_t record_bytes)
    : file_(file), compression_(std::move(compression)), record_bytes_(record_bytes) {}

Result<void> PointsWriter::begin() {
    begin_ = file_.position();
    return file_.append(std::vector<std::byte>(sizeof(uint64_t)));
}

Result<void> PointsWriter::write(std::span<const std::byte> records) {
    waiting_.insert(waiting_.end(), records.begin(), records.end());
    if (compression_.chunk_points == kVariableChunks) return {};
    const size_t chunk = size_t{compression_.chunk_points} * record_bytes_;
    for (size_t end = (ends_.size() + 1) * chunk; end <= waiting_.size(); end += chunk) cut(end);
    return ends_.size() < side_by_side() ? Result<void>{} : flush();
}

Result<void> PointsWriter::end_chunk() {
    cut(waiting_.size());
    return ends_.size() < side_by_side() ? Result<void>{} : flush();
}

void PointsWriter::cut(size_t end) {
    if (end > (ends_.empty() ? 0 : ends_.back())) ends_.push_back(end);
}

Result<void> PointsWriter::flush() {
    std::vector<std::vector<std::byte>> encoded(ends_.size());
    const auto begin_of = [&](size_t i) { return i ? ends_[i - 1] : 0; };
    parallel_ranges(encoded.size(), 1, [&](size_t i, size_t) {
        encoded[i] =
            encode_chunk(compression_, std::span(waiting_).subspan(begin_of(i), ends_[i] - begin_of(i)));
    });
    for (size_t i = 0; i < encoded.size(); ++i) {
        chunks_.push_back({file_.position(), encoded[i].size(), (ends_[i] - begin_of(i)) / record_bytes_});
        LUCARNE_TRY(file_.append(encoded[i]));
    }
    if (!ends_.empty())
        waiting_.erase(waiting_.begin(), waiting_.begin() + static_cast<std::ptrdiff_t>(ends_.back()));
    ends_.clear();
    return {};
}

Result<void> PointsWriter::finish() {
    cut(waiting_.size());
    LUCARNE_TRY(flush());
    std::vector<std::byte> table;
    put<uint32_t>(table, 0);  // version
    put(table, static_cast<uint32_t>(chunks_.size()));
    if (!chunks_.empty()) {
        Encoder encoder;
        IntegerModel model(32, 2);
        ChunkPlace last;
        for (const ChunkPlace& chunk : chunks_) {
            const auto code = [&](uint64_t before, uint64_t now, uint32_t context) {
                model.code(encoder, static_cast<int32_t>(before), static_cast<int32_t>(now), context);
            };
            if (compression_.chunk_points == kVariableChunks) code(last.points, chunk.points, 0);
            code(last.bytes, chunk.bytes, 1);
            last = chunk;
        }
        const auto bytes = encoder.finish();
        table.insert(table.end(), bytes.begin(), bytes.end());
    }
    std::vector<std::byte> place;
    put(place, file_.position());
    LUCARNE_TRY(file_.append(table));
    return file_.write_at(begin_, place);
}

}  // namespace lucarne::io::laz
