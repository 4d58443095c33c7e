#include "io/formats/e57/packets.h"

#include <algorithm>
#include <cstring>
#include <numeric>

#include <fmt/format.h>

#include "io/points.h"

namespace lucarne::io::e57 {
namespace {

constexpr size_t kSectionHeaderBytes = 32;
constexpr uint8_t kVectorSection = 1;
constexpr size_t kSlack = 16;  ///< bytes that unpack_bits may read after the last one
enum PacketType : uint8_t { kIndexPacket = 0, kDataPacket = 1, kEmptyPacket = 2 };
constexpr size_t kPacketHeaderBytes = 4, kDataHeaderBytes = 6;

}  // namespace

uint64_t record_bits(const Scan& scan) {
    return std::accumulate(
        scan.fields.begin(), scan.fields.end(), uint64_t{0},
        [](uint64_t sum, const Field& f) { return sum + (f.kind == Field::Kind::text ? 0 : f.bits); });
}

Result<Section> read_section(const std::shared_ptr<const ByteSource>& file, const FileHeader& header,
                             const Scan& scan, bool salvage) {
    const std::string name = file->path().string();
    const auto wrong = [&](const std::string& why) {
        return rejected(name, fmt::format("has a section of points at {} that {}", scan.section, why));
    };
    Section section;
    LUCARNE_ASSIGN(section.begin, logical_offset(name, header, scan.section, "a section of points"));
    if (header.bytes - section.begin < kSectionHeaderBytes) return wrong("reaches beyond its end");
    PageInput input(file, section.begin, section.begin + kSectionHeaderBytes, salvage);
    LUCARNE_ASSIGN(const auto raw, input.peek(kSectionHeaderBytes));
    if (static_cast<uint8_t>(raw[0]) != kVectorSection) return wrong("is not one");
    auto bytes = load<uint64_t>(&raw[8]);
    const auto data = load<uint64_t>(&raw[16]);
    if (salvage) bytes = std::min(bytes, header.bytes - section.begin);
    if (bytes < kSectionHeaderBytes || bytes > header.bytes - section.begin)
        return wrong("reaches beyond its end");
    section.end = section.begin + bytes;
    LUCARNE_ASSIGN(section.data, logical_offset(name, header, data, "a section's packets"));
    if (section.data < section.begin + kSectionHeaderBytes || section.data > section.end)
        return wrong("has its packets elsewhere");
    const uint64_t bits = record_bits(scan), there = 8 * (section.end - section.data);
    const uint64_t most = bits == 0 ? kMostConstant : there / bits;
    if (scan.records > most && (!salvage || bits == 0))
        return wrong(fmt::format("promises {} points, at most {} are there", scan.records, most));
    return section;
}

void unpack_bits(const std::byte* bytes, uint64_t first, unsigned bits, size_t count, uint64_t* values) {
    if (bits == 0) {
        std::fill_n(values, count, uint64_t{0});
        return;
    }
    const uint64_t mask = ~uint64_t{0} >> (64 - bits);
    if (bits <= 56) {
        for (size_t i = 0; i < count; ++i, first += bits)
            values[i] = load<uint64_t>(bytes + first / 8) >> first % 8 & mask;
        return;
    }
    for (size_t i = 0; i < count; ++i, first += bits) {
        const std::byte* at = bytes + first / 8;
        const auto shift = static_cast<unsigned>(first % 8);
        uint64_t value = load<uint64_t>(at) >> shift;
        if (shift != 0) value |= static_cast<uint64_t>(at[8]) << (64 - shift);
        values[i] = value & mask;
    }
}

RecordReader::RecordReader(const std::shared_ptr<const ByteSource>& file, const Section& section,
                           const Scan& scan, bool salvage)
    : input_(file, section.data, section.end, salvage),
      left_(scan.records),
      salvage_(salvage),
      streams_(scan.fields.size()),
      columns_(scan.fields.size() * kBlockRecords) {
    for (size_t i = 0; i < streams_.size(); ++i) {
        streams_[i].wanted = scan.fields[i].kind != Field::Kind::text && scan.fields[i].bits > 0;
        streams_[i].bits = streams_[i].wanted ? scan.fields[i].bits : 0;
    }
}

uint64_t RecordReader::Stream::values() const {
    return (8 * uint64_t{held} - next_bit) / bits;
}

/// Returns the number of records, up to `most`, for which every stream has values.
uint64_t RecordReader::complete(uint64_t most) const {
    for (const Stream& stream : streams_)
        if (stream.wanted) most = std::min(most, stream.values());
    return most;
}

size_t RecordReader::held() const {
    return std::accumulate(streams_.begin(), streams_.end(), size_t{0},
                           [](size_t sum, const Stream& stream) { return sum + stream.held; });
}

/// Reads packets until `wanted` records are complete. Returns how many are.
Result<uint64_t> RecordReader::gather(uint64_t wanted) {
    uint64_t count = complete(wanted);
    while (count < wanted && !broken_ && input_.left() >= kPacketHeaderBytes) {
        auto packet = next_data_packet();
        broken_ = salvage_ && !packet && packet.error().kind == ErrorKind::input_rejected;
        if (!packet && !broken_) return tl::unexpected(std::move(packet).error());
        count = complete(wanted);
    }
    return count;
}

/// Returns how many of the next records, at most `most`, come before the first with a wrong bit.
uint64_t RecordReader::sound_records(uint64_t most) {
    for (Stream& stream : streams_) {
        while (!stream.wrong.empty() && stream.wrong.front().second <= stream.next())
            stream.wrong.pop_front();
        if (stream.wrong.empty()) continue;
        const uint64_t begin = std::max(stream.wrong.front().first, stream.next());
        most = std::min(most, (begin - stream.next()) / stream.bits);
    }
    return most;
}

/// Returns how many records must be passed over, at most `most`, because the next one has a wrong bit.
uint64_t RecordReader::wrong_records(uint64_t most) const {
    uint64_t count = 1;
    for (const Stream& stream : streams_)
        if (!stream.wrong.empty() && stream.wrong.front().first < stream.next() + stream.bits)
            count = std::max(count,
                             (stream.wrong.front().second - stream.next() + stream.bits - 1) / stream.bits);
    return std::min(count, most);
}

Result<size_t> RecordReader::read(size_t most) {
    uint64_t count = 0;
    for (;;) {
        const uint64_t wanted = std::min<uint64_t>({most, kBlockRecords, left_});
        LUCARNE_ASSIGN(const uint64_t there, gather(wanted));
        if (there == 0 && wanted > 0 && !salvage_)
            return rejected(input_.path(), fmt::format("ends early: {} points of a scan are missing", left_));
        count = sound_records(there);
        if (count > 0 || there == 0) break;
        const uint64_t wrong = wrong_records(there);
        for (Stream& stream : streams_) stream.next_bit += wrong * stream.bits;
        left_ -= wrong;
        passed_over_ += wrong;
    }
    for (size_t i = 0; i < streams_.size(); ++i) {
        Stream& stream = streams_[i];
        if (!stream.wanted) continue;  // its column has been zero from the beginning
        unpack_bits(stream.bytes.data(), stream.next_bit, stream.bits, count, &columns_[i * kBlockRecords]);
        stream.next_bit += count * stream.bits;
    }
    left_ -= count;
    return count;
}

/// Reads the next packet with points. Skips other packets, and stops at the end of the section.
Result<void> RecordReader::next_data_packet() {
    while (input_.left() >= kPacketHeaderBytes) {
        LUCARNE_ASSIGN(const auto head, input_.peek(kPacketHeaderBytes));
        const auto type = static_cast<uint8_t>(head[0]);
        const size_t bytes = size_t{load<uint16_t>(&head[2])} + 1;
        if (bytes < kPacketHeaderBytes || type > kEmptyPacket)
            return rejected(input_.path(), "has a damaged packet of points");
        LUCARNE_ASSIGN(const auto packet, input_.peek(bytes));
        if (type == kDataPacket)
            LUCARNE_TRY(take_data_packet(packet.first(bytes)));
        else if (!input_.sound(input_.position(), input_.position() + kPacketHeaderBytes))
            return rejected(input_.path(), "has a damaged packet");
        input_.skip(bytes);
        if (type == kDataPacket) break;
    }
    return {};
}

Result<void> RecordReader::take_data_packet(std::span<const std::byte> packet) {
    const size_t count = packet.size() < kDataHeaderBytes ? 0 : load<uint16_t>(&packet[4]);
    const size_t first = kDataHeaderBytes + 2 * count;
    if (count != streams_.size() || packet.size() < first)
        return rejected(input_.path(), fmt::format("has a packet of {} streams where points have {} fields",
                                                   count, streams_.size()));
    const auto bytes_of = [&](size_t i) -> size_t {
        return load<uint16_t>(&packet[kDataHeaderBytes + 2 * i]);
    };
    size_t end = first;
    for (size_t i = 0; i < count; ++i) end += bytes_of(i);
    if (end > packet.size())
        return rejected(input_.path(), "has a packet of points whose streams are longer than itself");
    const uint64_t place = input_.position();
    // Packets are filled up to four bytes, so a damaged length hardly ever fits the others.
    if (!input_.sound(place, place + first) && (packet.size() % 4 != 0 || packet.size() - end > 3))
        return rejected(input_.path(), "has a packet of points whose header is damaged");
    size_t at = first;
    for (size_t i = 0; i < count; at += bytes_of(i++)) {
        if (!streams_[i].wanted) continue;
        mark_wrong(streams_[i], place + at, bytes_of(i));
        append(streams_[i], packet.subspan(at, bytes_of(i)));
    }
    if (held() > kMostAhead)
        return rejected(input_.path(),
                        fmt::format("has fields whose values lie over {} MiB apart", kMostAhead >> 20));
    return {};
}

/// Marks what a stream is about to get from pages with a wrong checksum: `bytes` from a logical place on.
void RecordReader::mark_wrong(Stream& stream, uint64_t begin, uint64_t bytes) const {
    for (const uint64_t page : input_.wrong_pages()) {
        const uint64_t from = std::max(begin, page * kPageContent),
                       to = std::min(begin + bytes, (page + 1) * kPageContent);
        if (from >= to) continue;
        const uint64_t offset = stream.passed + stream.held;
        const std::pair bits(8 * (offset + from - begin), 8 * (offset + to - begin));
        if (!stream.wrong.empty() && stream.wrong.back().second == bits.first)
            stream.wrong.back().second = bits.second;
        else
            stream.wrong.push_back(bits);
    }
}

void RecordReader::append(Stream& stream, std::span<const std::byte> bytes) {
    const auto done = static_cast<size_t>(stream.next_bit / 8);
    if (done > stream.held / 2) {  // moves no more bytes than are read, however far the stream is ahead
        std::memmove(stream.bytes.data(), stream.bytes.data() + done, stream.held - done);
        stream.held -= done;
        stream.next_bit -= 8 * uint64_t{done};
        stream.passed += done;
    }
    if (stream.bytes.size() < stream.held + bytes.size() + kSlack)
        stream.bytes.resize(std::max(stream.held + bytes.size() + kSlack, 2 * stream.bytes.size()));
    std::memcpy(stream.bytes.data() + stream.held, bytes.data(), bytes.size());
    stream.held += bytes.size();
}

}  // namespace lucarne::io::e57
