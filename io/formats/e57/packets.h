#pragma once

#include "io/formats/e57/document.h"
#include "io/formats/e57/pages.h"

// Binary sections (ASTM E2807-11, 9.3-9.5): the points of a scan are bytestreams, one a field, cut into
// packets. A stream's values are bits on end, lowest first; they run on from packet to packet.
namespace lucarne::io::e57 {

/// Where the packets of one scan lie, logical.
struct Section {
    uint64_t begin = 0;  ///< of the section with its header
    uint64_t data = 0, end = 0;
};

/// Reads and checks the header of a scan's section. Errors: no such section, one that reaches beyond the
/// file, more records than its bits can hold (kMostConstant where they take none). With `salvage` what lies
/// beyond the file is left out.
Result<Section> read_section(const std::shared_ptr<const ByteSource>& file, const FileHeader& header,
                             const Scan& scan, bool salvage = false);

/// What one record takes; 0 where all fields are constants.
uint64_t record_bits(const Scan& scan);
inline constexpr uint64_t kMostConstant = uint64_t{1} << 16;
inline constexpr size_t kBlockRecords = 1024;

/// The records of a scan, block by block, a column a field. Holds one buffer of the file and what of the
/// streams runs ahead of others, at most kMostAhead bytes.
class RecordReader {
 public:
    RecordReader(const std::shared_ptr<const ByteSource>& file, const Section& section, const Scan& scan,
                 bool salvage = false);

    /// Reads up to min(most, kBlockRecords) records; 0 at the end of the scan. Errors: damaged packets, and
    /// packets that end before the records do; with `salvage` the scan ends before them.
    Result<size_t> read(size_t most);
    uint64_t left() const { return left_; }  ///< records that were not read
    /// The values of a field in the last block: the bits of a float, or an integer less its minimum.
    const uint64_t* column(size_t field) const { return &columns_[field * kBlockRecords]; }

    static constexpr size_t kMostAhead = size_t{64} << 20;

 private:
    struct Stream {
        unsigned bits = 0;
        bool wanted = false;           ///< text is passed over
        std::vector<std::byte> bytes;  ///< with kSlack bytes behind them
        size_t held = 0;               ///< bytes that are of the stream
        uint64_t next_bit = 0;         ///< in `bytes`
        uint64_t values() const;
    };

    Result<void> next_data_packet();
    Result<void> take_data_packet(std::span<const std::byte> packet);
    static void append(Stream& stream, std::span<const std::byte> bytes);
    uint64_t complete(uint64_t most) const;
    size_t held() const;

    PageInput input_;
    uint64_t left_;
    bool salvage_, broken_ = false;
    std::vector<Stream> streams_;
    std::vector<uint64_t> columns_;
};

/// Unpacks `count` values of `bits` bits (0 to 64) from bit `first` on. Up to 8 bytes behind the last are
/// touched.
void unpack_bits(const std::byte* bytes, uint64_t first, unsigned bits, size_t count, uint64_t* values);

}  // namespace lucarne::io::e57
