#include "io/formats/las/header.h"

#include <algorithm>
#include <cmath>

#include <fmt/format.h>

#include "io/core/counted.h"
#include "io/core/log.h"
#include "io/formats/common/format.h"
#include "io/formats/common/text.h"
#include "io/formats/las/surplus.h"

namespace lucarne::io::las {
namespace {

constexpr size_t kVlrHeader = 54, kEvlrHeader = 60;
/// Compressed scans whose records exceed kLargeScan bytes do not shrink to less than 1 / kMostRatio. A
/// repeated flat raster may, but it is small.
constexpr uint64_t kLargeScan = uint64_t{256} << 20, kMostRatio = 4096;
constexpr uint64_t kRoomOfNoPoints = 1024;  ///< an empty chunk table takes fewer bytes than this

/// Reads a text field of fixed width: up to its first NUL, in printable ASCII.
std::string text_field(const std::byte* at, size_t width) {
    std::string text;
    for (size_t i = 0; i < width && at[i] != std::byte{0}; ++i) {
        const auto c = std::to_integer<char>(at[i]);
        text += c >= ' ' && c < 0x7f ? c : '?';
    }
    return text;
}

/// Reads records of one kind from [at, end). Stops with a warning at the first record that does not fit.
class RecordReader {
 public:
    RecordReader(const ByteSource& file, Header& header)
        : file_(file), out_(header.vlrs), losses_(header.losses) {}

    Result<void> read(bool extended, uint32_t count, uint64_t at, uint64_t end) {
        const uint64_t head_bytes = extended ? kEvlrHeader : kVlrHeader;
        const char* kind = extended ? "extended variable length records" : "variable length records";
        for (uint32_t n = 0; n < count; ++n) {
            if (n == kMostRecords)
                return rejected(file_.path().string(), fmt::format("has over {} {}", n, kind));
            std::array<std::byte, kEvlrHeader> head{};
            if (at > end || end - at < head_bytes) return stop(n, count, kind);
            LUCARNE_TRY(file_.read_at(at, std::span(head).first(head_bytes)));
            const uint64_t bytes = extended ? load<uint64_t>(&head[20]) : load<uint16_t>(&head[20]);
            at += head_bytes;
            if (bytes > end - at) return stop(n, count, kind);
            Vlr vlr{std::string(trimmed(text_field(&head[2], 16))),  // some writers pad it with blanks
                    load<uint16_t>(&head[18]),
                    text_field(&head[extended ? 28 : 22], 32),
                    extended,
                    {}};
            LUCARNE_TRY(keep(std::move(vlr), at, bytes));
            at += bytes;
        }
        return {};
    }

 private:
    Result<void> stop(uint32_t found, uint32_t promised, const char* kind) {
        log::warn("{}: {} promised, {} there", file_.path().string(), counted(promised, kind), found);
        add_loss(losses_, fmt::format("{} that are not there", kind), promised - found);
        return {};
    }
    Result<void> keep(Vlr vlr, uint64_t at, uint64_t bytes) {
        if (vlr.is("copc", 1000))
            return {};  // the COPC hierarchy: io/formats/copc/copc.h reads it page by page
        if (bytes > kMostRecordBytes - kept_) {
            log::warn("{}: the record {} {} of {} bytes is too large to be kept", file_.path().string(),
                      vlr.user_id, vlr.record_id, bytes);
            add_loss(losses_, "records that are too large to be kept", 1);
            return {};
        }
        kept_ += bytes;
        vlr.data.resize(static_cast<size_t>(bytes));
        LUCARNE_TRY(file_.read_at(at, vlr.data));
        out_.push_back(std::move(vlr));
        return {};
    }

    const ByteSource& file_;
    std::vector<Vlr>& out_;
    Losses& losses_;
    uint64_t kept_ = 0;
};

/// The numbers of the header block that are checked against each other.
struct RawHeader {
    uint16_t header_size = 0;
    uint32_t vlr_count = 0, evlr_count = 0;
    uint64_t evlr_offset = 0, wave_offset = 0;
    uint8_t format_byte = 0;
};
constexpr size_t kLargestHeader = 393;  ///< LAS 1.5

Header parse_block(const std::array<std::byte, kLargestHeader>& block, RawHeader& raw) {
    Header h;
    const std::byte* b = block.data();
    h.file_source_id = load<uint16_t>(b + 4);
    h.global_encoding = load<uint16_t>(b + 6);
    std::memcpy(h.guid.data(), b + 8, h.guid.size());
    h.minor = load<uint8_t>(b + 25);
    h.system_id = text_field(b + 26, 32);
    h.software = text_field(b + 58, 32);
    h.creation_day = load<uint16_t>(b + 90);
    h.creation_year = load<uint16_t>(b + 92);
    raw.header_size = load<uint16_t>(b + 94);
    h.points_offset = load<uint32_t>(b + 96);
    raw.vlr_count = load<uint32_t>(b + 100);
    raw.format_byte = load<uint8_t>(b + 104);
    const uint8_t format = raw.format_byte & 0x3f;
    h.point_format = without_waves(format);
    h.wave_bytes = h.point_format == format ? 0 : kWavePacketBytes;
    h.record_length = load<uint16_t>(b + 105);
    h.points = load<uint32_t>(b + 107);
    for (int axis = 0; axis < 3; ++axis) {
        h.scale[axis] = load<double>(b + 131 + 8 * axis);
        h.offset[axis] = load<double>(b + 155 + 8 * axis);
        h.high[axis] = load<double>(b + 179 + 16 * axis);
        h.low[axis] = load<double>(b + 187 + 16 * axis);
    }
    if (h.minor >= 3) raw.wave_offset = load<uint64_t>(b + 227);
    if (h.minor >= 4) {
        raw.evlr_offset = load<uint64_t>(b + 235);
        raw.evlr_count = load<uint32_t>(b + 243);
        // Some writers of 1.4 fill in only the old 32-bit count.
        if (const auto count = load<uint64_t>(b + 247); count != 0) h.points = count;
    }
    constexpr uint16_t kTimeOffset = 1 << 6;
    if (h.minor >= 5 && raw.header_size >= kLargestHeader && (h.global_encoding & kTimeOffset) != 0)
        add_loss(h.losses, "offsets of GPS times, which are not kept", load<uint16_t>(b + 391) != 0);
    return h;
}

Result<void> check_format(const std::string& name, const Header& h) {
    if (record_bytes(h.point_format) == 0)
        return rejected(name, fmt::format("has point format {}, which the LAS specification does not know",
                                          h.point_format));
    if (h.record_length < record_bytes(h.point_format) + h.wave_bytes)
        return rejected(name,
                        fmt::format("has records of {} bytes, but point format {} needs {}", h.record_length,
                                    h.point_format, record_bytes(h.point_format) + h.wave_bytes));
    for (int axis = 0; axis < 3; ++axis)
        if (!std::isnormal(h.scale[axis]) ||
            !usable(std::abs(h.scale[axis]) * 0x1p31 + std::abs(h.offset[axis])))
            return rejected(name, fmt::format("has no usable scale and offset for {} ({}, {})", "xyz"[axis],
                                              h.scale[axis], h.offset[axis]));
    return {};
}

Result<void> check_sizes(const ByteSource& file, const Header& h, const RawHeader& raw) {
    const std::string name = file.path().string();
    if (raw.header_size < header_bytes(h.minor))
        return rejected(name, fmt::format("has a header of {} bytes, but LAS 1.{} needs {}", raw.header_size,
                                          h.minor, header_bytes(h.minor)));
    if (h.points_offset < raw.header_size)
        return rejected(
            name, fmt::format("says that its points begin at byte {}, inside the header", h.points_offset));
    if (h.points_offset > file.size())
        return rejected(name, fmt::format("says that its points begin at byte {}, but it ends at {}",
                                          h.points_offset, file.size()));
    return {};
}

Result<void> check_points(const ByteSource& file, Header& h, const RawHeader& raw, bool salvage) {
    const uint64_t bytes = file.size() - h.points_offset;
    // Points cannot reach into the extended records or wave packets behind them.
    uint64_t end = file.size();
    for (const uint64_t record : {raw.evlr_count > 0 ? raw.evlr_offset : 0, raw.wave_offset}) {
        LUCARNE_ASSIGN(const bool there, is_extended_record(file, record));
        if (there && record >= h.points_offset) end = std::min(end, record);
    }
    if (salvage) {
        const uint64_t most =
            h.compressed ? bytes * kMostPointsAByte : (end - h.points_offset) / h.record_length;
        if (h.points > most) {
            add_loss(h.losses, lost::cut_off, h.points - most);
            h.points = most;
        }
    }
    if (h.compressed) {
        if (too_many_for(bytes, h.points, h.record_length))
            return rejected(file.path().string(), fmt::format("promises {}, more than its {} bytes can hold",
                                                              counted(h.points, "points"), file.size()));
        if (h.points == 0 && bytes > kRoomOfNoPoints && !salvage)
            log::warn(
                "{}: its header promises no points, but {} bytes follow; --salvage reads the points in them",
                file.path().string(), bytes);
        return {};
    }
    const uint64_t there = bytes / h.record_length;
    if (h.points > there)
        return rejected(file.path().string(),
                        fmt::format("is truncated: its header promises {}, {} {} there",
                                    counted(h.points, "points"), there, there == 1 ? "is" : "are"));
    return take_surplus(file, h, end, salvage);
}

}  // namespace

bool too_many_for(uint64_t compressed_bytes, uint64_t points, uint16_t record_length) {
    const bool bomb =
        points > kLargeScan / record_length && points / kMostRatio > compressed_bytes / record_length;
    return points / kMostPointsAByte > compressed_bytes || bomb;
}

const Vlr* Header::find(std::string_view user, uint16_t record) const {
    const auto found =
        std::find_if(vlrs.begin(), vlrs.end(), [&](const Vlr& v) { return v.is(user, record); });
    return found == vlrs.end() ? nullptr : &*found;
}

Result<Header> read_header(const ByteSource& file, bool salvage) {
    const std::string name = file.path().string();
    std::array<std::byte, kLargestHeader> block{};
    LUCARNE_ASSIGN(const size_t got, file.read_some(0, block));
    if (got < header_bytes(0))
        return rejected(name, fmt::format("ends inside its LAS header, at {} bytes", got));
    const auto major = load<uint8_t>(&block[24]), minor = load<uint8_t>(&block[25]);
    if (major != 1 || minor > 5)
        return rejected(name, fmt::format("is LAS {}.{}, which cannot be read", major, minor));
    if (got < header_bytes(minor))
        return rejected(name, fmt::format("ends inside its LAS header, at {} bytes", got));
    RawHeader raw;
    Header h = parse_block(block, raw);
    LUCARNE_TRY(check_sizes(file, h, raw));
    RecordReader records(file, h);
    LUCARNE_TRY(records.read(false, raw.vlr_count, raw.header_size, h.points_offset));
    h.compressed = (raw.format_byte & 0xc0) != 0 || h.find("laszip encoded", 22204) != nullptr;
    LUCARNE_TRY(check_format(name, h));
    LUCARNE_TRY(check_points(file, h, raw, salvage));
    if (raw.evlr_count > 0) {
        if (raw.evlr_offset < h.points_offset + (h.compressed ? 0 : h.points * h.record_length))
            log::warn("{}: its extended records begin inside the points, they are left out", name);
        else
            LUCARNE_TRY(records.read(true, raw.evlr_count, raw.evlr_offset, file.size()));
    }
    return h;
}

}  // namespace lucarne::io::las
