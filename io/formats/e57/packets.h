#pragma once

#include <deque>
#include <utility>

#include "io/formats/e57/document.h"
#include "io/formats/e57/pages.h"

// Binary sections (ASTM E2807-11, 9.3-9.5). The points of a scan are bytestreams, one per field, cut into
// packets. The values of a stream are packed bit by bit, lowest bit first, and continue from packet to
// packet.
namespace lucarne::io::e57 {

/// Where the packets of one scan lie, as logical offsets.
struct Section {
    uint64_t begin = 0;  ///< of the section with its header
    uint64_t data = 0, end = 0;
};

/// Reads and checks the header of a scan's section. Errors: no such section, a section that reaches beyond
/// the file, more records than its bits can hold (kMostConstant if a record takes no bits). With `salvage`
/// the part beyond the file is left out, and the checksum of the section's header may be wrong.
Result<Section> read_section(const std::shared_ptr<const ByteSource>& file, const FileHeader& header,
                             const Scan& scan, bool salvage = false);

/// Returns the bits that one record takes; 0 if all fields are constants.
uint64_t record_bits(const Scan& scan);
inline constexpr uint64_t kMostConstant = uint64_t{1} << 16;
inline constexpr size_t kBlockRecords = 1024;

/// Reads the records of a scan block by block, as one column per field. Holds one buffer of the file, and the
/// part of some streams that runs ahead of others: at most kMostAhead bytes.
class RecordReader {
 public:
    RecordReader(const std::shared_ptr<const ByteSource>& file, const Section& section, const Scan& scan,
                 bool salvage = false);

    /// Reads up to min(most, kBlockRecords) records. Returns their number, 0 at the end of the scan. Errors:
    /// damaged packets, and packets that end before the records do. With `salvage` the scan ends before these
    /// instead, and records of which a bit lies in a page with a wrong checksum are passed over. The header
    /// of a packet in such a page counts if its lengths add up.
    Result<size_t> read(size_t most);
    /// Returns the records that are not read yet or were passed over.
    uint64_t missing() const { return left_ + passed_over_; }
    /// Returns a field's values in the last block: the bits of a float, or an integer less its minimum.
    const uint64_t* column(size_t field) const { return &columns_[field * kBlockRecords]; }

    static constexpr size_t kMostAhead = size_t{64} << 20;

 private:
    struct Stream {
        unsigned bits = 0;
        bool wanted = false;           ///< false for text, which is skipped
        std::vector<std::byte> bytes;  ///< followed by kSlack spare bytes
        size_t held = 0;               ///< bytes that belong to the stream
        uint64_t next_bit = 0;         ///< in `bytes`
        uint64_t passed = 0;           ///< bytes that were removed from the front of `bytes`
        /// Bits in pages with a wrong checksum, counted from the beginning of the stream.
        std::deque<std::pair<uint64_t, uint64_t>> wrong;
        uint64_t values() const;
        uint64_t next() const { return 8 * passed + next_bit; }
    };

    Result<void> next_data_packet();
    Result<void> take_data_packet(std::span<const std::byte> packet);
    void mark_wrong(Stream& stream, uint64_t begin, uint64_t bytes) const;
    static void append(Stream& stream, std::span<const std::byte> bytes);
    uint64_t complete(uint64_t most) const;
    Result<uint64_t> gather(uint64_t wanted);
    uint64_t sound_records(uint64_t most);
    uint64_t wrong_records(uint64_t most) const;
    size_t held() const;

    PageInput input_;
    uint64_t left_, passed_over_ = 0;
    bool salvage_, broken_ = false;
    std::vector<Stream> streams_;
    std::vector<uint64_t> columns_;
};

/// Unpacks `count` values of `bits` bits (0 to 64), starting at bit `first`. May read up to 8 bytes after the
/// last value.
void unpack_bits(const std::byte* bytes, uint64_t first, unsigned bits, size_t count, uint64_t* values);

}  // namespace lucarne::io::e57
