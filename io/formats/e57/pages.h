#pragma once

#include <memory>
#include <span>
#include <string>
#include <string_view>
#include <vector>

#include "io/files/file.h"

// The lowest layer of E57 (ASTM E2807-11, 6.2-6.3): pages of 1024 bytes. The last four bytes of a page are
// the CRC-32C of the others, highest byte first. Physical offsets count all bytes; logical offsets leave out
// the checksums.
namespace lucarne::io::e57 {

inline constexpr uint64_t kPageBytes = 1024, kPageContent = 1020;
inline constexpr size_t kHeaderBytes = 48;

/// Losses of checksums that protect no point.
inline constexpr std::string_view kWrongPages = "pages of its description whose checksum is wrong",
                                  kCutChecksums = "checksums that are cut off";

struct FileHeader {
    uint64_t bytes = 0;                   ///< logical length of the whole file
    uint64_t xml_begin = 0, xml_end = 0;  ///< logical
    bool wrong = false;                   ///< with `salvage`: the checksum of the first page is wrong
    bool cut = false;                     ///< with `salvage`: the checksum of the last page is cut off
};

/// Reads and checks the file header. Errors: versions and page sizes other than the standard's, a file
/// shorter than its header says or than its XML. With `salvage` the file may be shorter than its header says,
/// as long as its XML is there; its last page may lack its checksum, or a part of it.
Result<FileHeader> read_file_header(const std::shared_ptr<const ByteSource>& file, bool salvage = false);

/// Converts a physical offset to a logical one. The offset must be inside the file and not inside a checksum.
/// `what` names it in errors.
Result<uint64_t> logical_offset(const std::string& file, const FileHeader& header, uint64_t physical,
                                const std::string& what);

/// Reads the logical range [begin, end) sequentially and verifies the checksum of every page. Holds one
/// buffer, no larger than the range needs.
class PageInput {
 public:
    /// With `salvage` pages whose checksum is wrong are read as well, see wrong_pages().
    PageInput(std::shared_ptr<const ByteSource> file, uint64_t begin, uint64_t end, bool salvage = false);

    /// Returns at least `bytes` bytes (at most kLargestPeek). Fewer left in the range is an error. Valid
    /// until the next call.
    Result<std::span<const std::byte>> peek(size_t bytes);
    void skip(size_t bytes) { first_ += bytes; }  ///< part of what `peek` returned
    uint64_t position() const { return next_page_ * kPageContent + skip_first_ - (last_ - first_); }
    uint64_t left() const { return position() < end_ ? end_ - position() : 0; }
    /// With `salvage`: the numbers of the pages with a wrong checksum, ascending, at least those of what
    /// `peek` returned last.
    std::span<const uint64_t> wrong_pages() const { return wrong_pages_; }
    /// Returns whether a logical range, of what `peek` returned last, lies in pages with the right checksum.
    bool sound(uint64_t begin, uint64_t end) const;
    std::string path() const { return file_->path().string(); }

    static constexpr size_t kLargestPeek = size_t{1} << 16;

 private:
    Result<void> fill();
    /// Reads whole pages. The last page of the file may lack some of its checksum; returns how many bytes.
    Result<uint64_t> read_pages(std::span<std::byte> pages) const;

    std::shared_ptr<const ByteSource> file_;
    uint64_t next_page_, end_;
    bool salvage_;
    size_t skip_first_;  ///< bytes of the first page that lie before the range
    std::vector<std::byte> buffer_;
    size_t first_ = 0, last_ = 0;  ///< the buffered bytes that are not consumed yet
    std::vector<uint64_t> wrong_pages_;
};

}  // namespace lucarne::io::e57
