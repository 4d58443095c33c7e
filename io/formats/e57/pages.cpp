#include "io/formats/e57/pages.h"

#include <algorithm>
#include <array>
#include <cstring>
#include <utility>

#include <fmt/format.h>

#include "io/formats/e57/crc32c.h"
#include "io/points.h"

namespace lucarne::io::e57 {
namespace {

constexpr uint64_t kPagesAtOnce = 256;
constexpr uint64_t kChecksumBytes = kPageBytes - kPageContent;

}  // namespace

Result<FileHeader> read_file_header(const std::shared_ptr<const ByteSource>& file, bool salvage) {
    const std::string name = file->path().string();
    std::array<std::byte, kHeaderBytes> raw{};
    LUCARNE_TRY(file->read_at(0, raw));
    const auto major = load<uint32_t>(&raw[8]), minor = load<uint32_t>(&raw[12]);
    auto physical_bytes = load<uint64_t>(&raw[16]);
    const auto xml_offset = load<uint64_t>(&raw[24]), xml_bytes = load<uint64_t>(&raw[32]);
    const auto page_bytes = load<uint64_t>(&raw[40]);
    if (major != 1) return rejected(name, fmt::format("is E57 {}.{}; only 1.x is known", major, minor));
    if (page_bytes != kPageBytes)
        return rejected(name, fmt::format("has pages of {} bytes instead of {}", page_bytes, kPageBytes));
    if (physical_bytes > file->size()) {
        const bool described = xml_offset < file->size() && xml_bytes < file->size() - xml_offset;
        if (!salvage || !described)
            return rejected(name, fmt::format("is truncated: its header promises {} bytes, {} are there{}",
                                              physical_bytes, file->size(),
                                              described ? ""
                                                        : "; the description of its points, which stands at "
                                                          "the end, is gone, so none can be saved"));
        physical_bytes = (file->size() + kChecksumBytes) / kPageBytes * kPageBytes;
    }
    if (physical_bytes == 0 || physical_bytes % kPageBytes != 0)
        return rejected(name,
                        fmt::format("has a length of {} bytes, which are no whole pages", physical_bytes));
    FileHeader header;
    header.bytes = physical_bytes / kPageBytes * kPageContent;
    PageInput first_page(file, 0, kHeaderBytes, salvage);
    LUCARNE_TRY(first_page.peek(kHeaderBytes));
    header.cut = physical_bytes > file->size();
    header.wrong = !first_page.wrong_pages().empty();
    LUCARNE_ASSIGN(header.xml_begin, logical_offset(name, header, xml_offset, "the XML section"));
    if (xml_bytes > header.bytes - header.xml_begin)
        return rejected(name,
                        fmt::format("has an XML section of {} bytes that reaches beyond its end", xml_bytes));
    header.xml_end = header.xml_begin + xml_bytes;
    return header;
}

Result<uint64_t> logical_offset(const std::string& file, const FileHeader& header, uint64_t physical,
                                const std::string& what) {
    const uint64_t page = physical / kPageBytes, within = physical % kPageBytes;
    if (page >= header.bytes / kPageContent)
        return rejected(file, fmt::format("has {} at {}, beyond its end", what, physical));
    if (within >= kPageContent || physical < kHeaderBytes)
        return rejected(file, fmt::format("has {} at {}, inside {}", what, physical,
                                          physical < kHeaderBytes ? "its header" : "a checksum"));
    return page * kPageContent + within;
}

PageInput::PageInput(std::shared_ptr<const ByteSource> file, uint64_t begin, uint64_t end, bool salvage)
    : file_(std::move(file)),
      next_page_(begin / kPageContent),
      end_(end),
      salvage_(salvage),
      skip_first_(static_cast<size_t>(begin % kPageContent)) {
    if (end <= begin) return;
    const uint64_t pages = (end + kPageContent - 1) / kPageContent - next_page_;
    // There is room for the pages that are read at once, after the unconsumed bytes of earlier pages.
    buffer_.resize(static_cast<size_t>(std::min(pages, kPagesAtOnce) * kPageBytes) +
                   (pages > kPagesAtOnce ? kLargestPeek : 0));
}

Result<std::span<const std::byte>> PageInput::peek(size_t bytes) {
    while (last_ - first_ < bytes) {
        if (next_page_ * kPageContent >= end_) break;
        LUCARNE_TRY(fill());
    }
    const uint64_t past_end = next_page_ * kPageContent > end_ ? next_page_ * kPageContent - end_ : 0;
    const size_t buffered = last_ - first_;
    const size_t usable_bytes = past_end < buffered ? buffered - static_cast<size_t>(past_end) : 0;
    if (usable_bytes < bytes) return rejected(path(), "has a section that ends early");
    return std::span<const std::byte>(buffer_).subspan(first_, usable_bytes);
}

bool PageInput::sound(uint64_t begin, uint64_t end) const {
    const auto first = std::ranges::lower_bound(wrong_pages_, begin / kPageContent);
    return first == wrong_pages_.end() || *first * kPageContent >= end;
}

Result<uint64_t> PageInput::read_pages(std::span<std::byte> pages) const {
    const uint64_t begin = next_page_ * kPageBytes, end = begin + pages.size();
    const uint64_t cut = salvage_ && end > file_->size() ? end - file_->size() : 0;
    if (cut > kChecksumBytes) return rejected(path(), "has a section that ends early");
    LUCARNE_TRY(file_->read_at(begin, pages.first(pages.size() - static_cast<size_t>(cut))));
    return cut;
}

/// Reads as many pages as fit after the unconsumed bytes, verifies them and closes the gaps left by their
/// checksums.
Result<void> PageInput::fill() {
    std::erase_if(wrong_pages_, [&](uint64_t page) { return (page + 1) * kPageContent <= position(); });
    std::memmove(buffer_.data(), buffer_.data() + first_, last_ - first_);
    last_ -= first_;
    first_ = 0;
    const uint64_t wanted = (end_ + kPageContent - 1) / kPageContent - next_page_;
    const uint64_t pages = std::min<uint64_t>(wanted, (buffer_.size() - last_) / kPageBytes);
    const auto read = std::span(buffer_).subspan(last_, static_cast<size_t>(pages * kPageBytes));
    LUCARNE_ASSIGN(const uint64_t cut, read_pages(read));
    for (uint64_t page = 0; page < pages; ++page) {
        const auto content = read.subspan(static_cast<size_t>(page * kPageBytes), kPageContent);
        const uint32_t checksum = __builtin_bswap32(crc32c(content));
        const size_t there = kChecksumBytes - static_cast<size_t>(page + 1 == pages ? cut : 0);
        if (std::memcmp(content.data() + kPageContent, &checksum, there) != 0) {
            if (!salvage_)
                return rejected(path(),
                                fmt::format("is damaged: the checksum of the page at byte {} is wrong",
                                            (next_page_ + page) * kPageBytes));
            wrong_pages_.push_back(next_page_ + page);
        }
        std::memmove(buffer_.data() + last_, content.data(), kPageContent);
        last_ += kPageContent;
    }
    next_page_ += pages;
    first_ += std::exchange(skip_first_, 0);
    return {};
}

}  // namespace lucarne::io::e57
