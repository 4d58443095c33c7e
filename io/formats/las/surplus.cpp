#include "io/formats/las/surplus.h"

#include <algorithm>

#include "io/formats/common/surplus.h"
#include "io/formats/las/bounds.h"

namespace lucarne::io::las {
namespace {

/// Returns how many of the `most` records from `begin` on are points.
Result<uint64_t> count_records(const ByteSource& file, const Header& header, uint64_t begin, uint64_t most) {
    constexpr uint64_t kBlockBytes = uint64_t{1} << 20;
    const StatedBounds bounds(header);
    if (most == 0 || (header.points > 0 && !bounds.stated())) return 0u;
    const uint64_t length = header.record_length;
    std::vector<std::byte> block(std::min(kBlockBytes / length, most) * length);
    for (uint64_t count = 0; count < most;) {
        const auto records = static_cast<size_t>(std::min<uint64_t>(block.size() / length, most - count));
        LUCARNE_TRY(file.read_at(begin + count * length, std::span(block).first(records * length)));
        size_t good = bounds.outside(block.data(), records, length).value_or(records);
        for (size_t i = 0; i < good; ++i) {
            const auto record = std::span(block).subspan(i * length, length);
            if (std::ranges::all_of(record, [](std::byte b) { return b == std::byte{0}; })) good = i;
        }
        count += good;
        if (good < records) return count;
    }
    return most;
}

}  // namespace

Result<bool> is_extended_record(const ByteSource& file, uint64_t offset) {
    constexpr uint64_t kHeadBytes = 60, kLengthAt = 20;
    if (offset == 0 || offset > file.size() || file.size() - offset < kHeadBytes) return false;
    std::array<std::byte, sizeof(uint64_t)> length{};
    LUCARNE_TRY(file.read_at(offset + kLengthAt, length));
    return load<uint64_t>(length.data()) <= file.size() - offset - kHeadBytes;
}

Result<void> take_surplus(const ByteSource& file, Header& header, uint64_t end, bool salvage) {
    const uint64_t counted_end = header.points_offset + header.points * header.record_length;
    if (counted_end >= end) return {};
    const uint64_t bytes = end - counted_end, most = bytes / header.record_length;
    // Without `salvage` one record tells whether these may be points.
    LUCARNE_ASSIGN(const uint64_t records,
                   count_records(file, header, counted_end, salvage ? most : std::min<uint64_t>(most, 1)));
    if (salvage) header.points += records;
    const uint64_t rest = bytes - (salvage ? records * header.record_length : 0);
    if (rest > 0) warn_of_surplus(file.path().string(), rest, !salvage && records > 0 ? most : 0);
    return {};
}

}  // namespace lucarne::io::las
