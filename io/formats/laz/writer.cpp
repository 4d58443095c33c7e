#include "io/formats/laz/writer.h"

#include <algorithm>
#include <thread>

#include "io/core/parallel.h"
#include "io/formats/laz/chunk_encoder.h"
#include "io/formats/laz/encoder.h"
#include "io/formats/laz/integers.h"

namespace lucarne::io::laz {
namespace {

constexpr uint16_t kLayeredItems = 3, kLayeredChunked = 3;
constexpr uint8_t kMajor = 3, kMinor = 4;  ///< of the LASzip that first wrote such files as these

template <class T>
void put(std::vector<std::byte>& bytes, T value) {
    bytes.resize(bytes.size() + sizeof value);
    store(&bytes[bytes.size() - sizeof value], value);
}

}  // namespace

Compression layered_compression(const las::Header& header) {
    return {true, true, 50'000, items_of(header, kLayeredItems)};
}

las::Vlr compression_record(const Compression& compression) {
    las::Vlr record{std::string(kUser), kRecord, "LAZ compressed points", false, {}};
    std::vector<std::byte>& data = record.data;
    put(data, kLayeredChunked);
    put<uint16_t>(data, 0);  // the arithmetic coder
    put(data, kMajor);
    put(data, kMinor);
    put<uint16_t>(data, 0);  // revision
    put<uint32_t>(data, 0);  // options
    put(data, compression.chunk_points);
    put<int64_t>(data, -1);  // no special records: how many, where
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
    return flush(false);
}

Result<void> PointsWriter::flush(bool all) {
    const size_t chunk = size_t{compression_.chunk_points} * record_bytes_;
    const size_t side_by_side = std::max(1u, std::thread::hardware_concurrency());
    if (!all && waiting_.size() < side_by_side * chunk) return {};
    const size_t count = all ? (waiting_.size() + chunk - 1) / chunk : waiting_.size() / chunk;
    std::vector<std::vector<std::byte>> encoded(count);
    parallel_ranges(count, 1, [&](size_t begin, size_t end) {
        for (size_t i = begin; i < end; ++i)
            encoded[i] = encode_chunk(
                compression_,
                std::span(waiting_).subspan(i * chunk, std::min(chunk, waiting_.size() - i * chunk)));
    });
    for (const auto& bytes : encoded) {
        LUCARNE_TRY(file_.append(bytes));
        chunk_bytes_.push_back(static_cast<uint32_t>(bytes.size()));
    }
    const size_t done = std::min(waiting_.size(), count * chunk);
    waiting_.erase(waiting_.begin(), waiting_.begin() + static_cast<std::ptrdiff_t>(done));
    return {};
}

Result<void> PointsWriter::finish() {
    LUCARNE_TRY(flush(true));
    std::vector<std::byte> table;
    put<uint32_t>(table, 0);  // version
    put(table, static_cast<uint32_t>(chunk_bytes_.size()));
    if (!chunk_bytes_.empty()) {
        Encoder encoder;
        IntegerModel model(32, 2);
        for (size_t i = 0; i < chunk_bytes_.size(); ++i)
            model.code(encoder, i ? static_cast<int32_t>(chunk_bytes_[i - 1]) : 0,
                       static_cast<int32_t>(chunk_bytes_[i]), 1);
        const auto code = encoder.finish();
        table.insert(table.end(), code.begin(), code.end());
    }
    std::vector<std::byte> place;
    put(place, file_.position());
    LUCARNE_TRY(file_.append(table));
    return file_.write_at(begin_, place);
}

}  // namespace lucarne::io::laz
