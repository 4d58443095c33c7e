// LAS 1.0-1.4 and LAZ. Source: see header.h.
#include "io/formats/las/writer.h"

#include <algorithm>
#include <array>

#include <fmt/format.h>

#include "io/core/log.h"
#include "io/files/file.h"
#include "io/formats/las/extras.h"

namespace lucarne::io::las {
namespace {

constexpr uint64_t kMost32 = std::numeric_limits<uint32_t>::max();
constexpr size_t kPieceBytes = size_t{2} << 20;
constexpr uint8_t kCompressedBit = 0x80;

/// Appends little-endian fields.
class Bytes {
 public:
    template <class T>
    void put(T value) {
        data_.resize(data_.size() + sizeof value);
        store(&data_[data_.size() - sizeof value], value);
    }
    void text(std::string_view text, size_t width) {
        const auto cut = std::as_bytes(std::span(text.substr(0, width)));
        data_.insert(data_.end(), cut.begin(), cut.end());
        data_.resize(data_.size() + width - cut.size());
    }
    std::span<const std::byte> data() const { return data_; }

 private:
    std::vector<std::byte> data_;
};

/// Appends a record's own header; its data must follow.
void append_record_header(Bytes& out, const Vlr& vlr, uint8_t minor) {
    out.put<uint16_t>(minor == 0 ? 0xaabb : 0);  // a signature in LAS 1.0, reserved since then
    out.text(vlr.user_id, 16);
    out.put(vlr.record_id);
    if (vlr.extended)
        out.put<uint64_t>(vlr.data.size());
    else
        out.put(static_cast<uint16_t>(vlr.data.size()));
    out.text(vlr.description, 32);
}

Bytes header_block(const Header& h, const Statistics& s, uint64_t points_offset, uint64_t evlr_offset) {
    const auto records = static_cast<uint32_t>(
        std::count_if(h.vlrs.begin(), h.vlrs.end(), [](const Vlr& v) { return !v.extended; }));
    // Readers of LAS 1.3 and older know only the 32-bit counts, which must be 0 for point formats 6 and up.
    const bool old_counts = !extended_format(h.point_format) && h.points <= kMost32;
    Bytes b;
    b.text("LASF", 4);
    b.put(h.file_source_id);
    b.put(h.global_encoding);
    for (const uint8_t byte : h.guid) b.put(byte);
    b.put<uint8_t>(1);
    b.put(h.minor);
    b.text(h.system_id, 32);
    b.text(h.software, 32);
    b.put(h.creation_day);
    b.put(h.creation_year);
    b.put(header_bytes(h.minor));
    b.put(static_cast<uint32_t>(points_offset));
    b.put(records);
    b.put(static_cast<uint8_t>(h.point_format | (h.compressed ? kCompressedBit : 0)));
    b.put(h.record_length);
    b.put(static_cast<uint32_t>(old_counts ? h.points : 0));
    for (size_t r = 1; r <= 5; ++r) b.put(static_cast<uint32_t>(old_counts ? s.returns[r] : 0));
    for (int axis = 0; axis < 3; ++axis) b.put(h.scale[axis]);
    for (int axis = 0; axis < 3; ++axis) b.put(h.offset[axis]);
    for (int axis = 0; axis < 3; ++axis) {
        const auto at = [&](int32_t value) {
            return h.points == 0 ? 0.0 : value * h.scale[axis] + h.offset[axis];
        };
        const auto [low, high] =
            std::minmax({at(s.low[static_cast<size_t>(axis)]), at(s.high[static_cast<size_t>(axis)])});
        b.put(high);
        b.put(low);
    }
    if (h.minor >= 3) b.put<uint64_t>(0);  // no wave packets
    if (h.minor >= 4) {
        b.put(evlr_offset);
        b.put(static_cast<uint32_t>(h.vlrs.size() - records));
        b.put(h.points);
        for (size_t r = 1; r <= 15; ++r) b.put(s.returns[r]);
    }
    return b;
}

/// Returns the records that come before the points.
Result<Bytes> front_records(const std::string& path, const Header& header) {
    Bytes front;
    for (const Vlr& vlr : header.vlrs) {
        if (vlr.extended) continue;
        if (vlr.data.size() > 0xffff)
            return failed(path, fmt::format("the record {} is too large", vlr.user_id));
        append_record_header(front, vlr, header.minor);
        front.text(vlr.text(), vlr.data.size());
    }
    if (header.minor == 0) front.put<uint16_t>(0xddcc);  // LAS 1.0 has a signature before the points
    return front;
}

}  // namespace

Statistics::Statistics() {
    low.fill(std::numeric_limits<int32_t>::max());
    high.fill(std::numeric_limits<int32_t>::min());
}

void Statistics::add(const std::byte* records, size_t count, size_t stride, const Schema& fields) {
    const size_t return_offset = fields.find(names::return_number)->offset;
    const Attribute* time = fields.find(names::gps_time);
    for (; count-- > 0; records += stride) {
        for (size_t axis = 0; axis < 3; ++axis) {
            const auto value = load<int32_t>(records + 4 * axis);
            low[axis] = std::min(low[axis], value);
            high[axis] = std::max(high[axis], value);
        }
        ++returns[load<uint8_t>(records + return_offset) & 15];
        if (!time) continue;
        const auto at = load<double>(records + time->offset);
        gps_low = std::min(gps_low, at);  // NaN changes nothing
        gps_high = std::max(gps_high, at);
    }
}

Writer::Writer(OutputFile file, std::string path, Target target, uint32_t in_stride)
    : file_(std::move(file)), path_(std::move(path)), target_(std::move(target)), in_stride_(in_stride) {}

Result<void> Writer::begin(uint32_t chunk_points) {
    if (target_.header.compressed) {
        const auto compression = laz::usual_compression(target_.header, chunk_points);
        target_.header.vlrs.push_back(laz::compression_record(compression));
        compressed_.emplace(file_, compression, target_.header.record_length);
    }
    LUCARNE_ASSIGN(const Bytes front, front_records(path_, target_.header));
    points_offset_ = header_bytes(target_.header.minor) + front.data().size();
    if (points_offset_ > kMost32) return failed(path_, "has more records than LAS can hold");
    LUCARNE_TRY(file_.append(std::vector<std::byte>(header_bytes(target_.header.minor))));
    LUCARNE_TRY(file_.append(front.data()));
    return compressed_ ? compressed_->begin() : Result<void>{};
}

Result<void> Writer::write(std::span<const std::byte> records) {
    const size_t piece =
        std::max<size_t>(1, kPieceBytes / std::max<size_t>(in_stride_, target_.schema.stride));
    for (size_t left = records.size() / in_stride_; left > 0;) {
        const size_t count = std::min(left, piece);
        LUCARNE_TRY(write_piece(records.data(), count));
        records = records.subspan(count * in_stride_);
        left -= count;
    }
    return {};
}

Result<void> Writer::end_chunk() {
    LUCARNE_TRY(flush());
    return compressed_->end_chunk();
}

Result<void> Writer::finish_points() {
    LUCARNE_TRY(flush());
    points_done_ = true;
    return compressed_ ? compressed_->finish() : Result<void>{};
}

Result<void> Writer::finish() {
    if (!points_done_) LUCARNE_TRY(finish_points());
    const uint64_t evlr_offset = file_.position();
    const Header& header = target_.header;
    bool any = false;
    for (const Vlr& vlr : header.vlrs) {
        if (!vlr.extended || header.minor < 4) continue;
        Bytes head;
        append_record_header(head, vlr, header.minor);
        LUCARNE_TRY(file_.append(head.data()));
        LUCARNE_TRY(file_.append(vlr.data));
        any = true;
    }
    LUCARNE_TRY(
        file_.write_at(0, header_block(header, statistics_, points_offset_, any ? evlr_offset : 0).data()));
    LUCARNE_ASSIGN(const Bytes front, front_records(path_, header));
    LUCARNE_TRY(file_.write_at(header_bytes(header.minor), front.data()));
    LUCARNE_TRY(file_.commit());
    if (const double most = target_.converter.rounded(); most > 0)
        log::warn("{}: coordinates are rounded, by at most {:.2g}: its integers cannot hold all their digits",
                  path_, most);
    return {};
}

Result<void> Writer::write_piece(const std::byte* in, size_t count) {
    Header& header = target_.header;
    if (header.minor < 4 && header.points + count > kMost32)
        return failed(path_, fmt::format("LAS 1.{} cannot count more than {} points", header.minor, kMost32));
    const size_t stride = target_.schema.stride;
    if (!target_.converter.identity()) {
        converted_.resize(count * stride);
        if (!target_.converter.convert(in, count, converted_.data()))
            return failed(path_,
                          fmt::format("a position does not fit 32-bit integers of scale {}, {}, {}",
                                      header.scale.x, header.scale.y, header.scale.z),
                          "choose PLY, which holds doubles");
        in = converted_.data();
    }
    statistics_.add(in, count, stride, fields_of(header));
    const size_t at = buffer_.size();
    buffer_.resize(at + count * header.record_length);
    if (!encode(header, in, stride, count, buffer_.data() + at))
        return failed(
            path_,
            fmt::format("a class, flag or return number does not fit point format {}", header.point_format),
            "choose PLY");
    header.points += count;
    return buffer_.size() >= kPieceBytes ? flush() : Result<void>{};
}

Result<void> Writer::flush() {
    LUCARNE_TRY(compressed_ ? compressed_->write(buffer_) : file_.append(buffer_));
    buffer_.clear();
    return {};
}

namespace {

Result<std::unique_ptr<PointWriter>> create(const std::filesystem::path& path, const Schema& schema,
                                            const ScanInfo& info, const WriteOptions& options,
                                            Container container) {
    LUCARNE_ASSIGN(auto target, make_target(path.string(), schema, info, options, container));
    LUCARNE_ASSIGN(auto file, OutputFile::create(path, options.overwrite));
    auto writer = std::make_unique<Writer>(std::move(file), path.string(), std::move(target), schema.stride);
    LUCARNE_TRY(writer->begin());
    return writer;
}

}  // namespace

Result<std::unique_ptr<PointWriter>> create(const std::filesystem::path& path, const Schema& schema,
                                            const ScanInfo& info, const WriteOptions& options) {
    return create(path, schema, info, options, Container::las);
}

Result<std::unique_ptr<PointWriter>> create_compressed(const std::filesystem::path& path,
                                                       const Schema& schema, const ScanInfo& info,
                                                       const WriteOptions& options) {
    return create(path, schema, info, options, Container::laz);
}

}  // namespace lucarne::io::las
