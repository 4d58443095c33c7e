#include "io/formats/copc/hierarchy.h"

#include <algorithm>
#include <map>

#include <fmt/format.h>

namespace lucarne::io::copc {
namespace {

constexpr uint64_t kBlockBytes = kEntryBytes << 15;  ///< of a page, read at a time
constexpr int32_t kPage = -1;                        ///< in place of a number of points: refers to a page

auto refused(const ByteSource& file, const std::string& why) {
    return rejected(file.path().string(), why, "convert it, which reads it as the LAZ that it is");
}

class HierarchyReader {
 public:
    HierarchyReader(const ByteSource& file, const las::Header& header) : file_(file), header_(header) {}

    Result<std::vector<Node>> read(const Info& info) {
        LUCARNE_TRY(add_page(info.page_offset, info.page_bytes));
        for (size_t next = 0; next < pages_.size(); ++next) LUCARNE_TRY(read_page(pages_[next]));
        LUCARNE_TRY(check_chunks());
        return std::move(nodes_);
    }

 private:
    struct Page {
        uint64_t offset, bytes;
    };

    /// Adds a page. No two pages may share a byte, so there is no cycle, and all entries together are no
    /// larger than the file.
    Result<void> add_page(uint64_t offset, uint64_t bytes) {
        if (offset > file_.size() || bytes > file_.size() - offset)
            return rejected(file_.path().string(),
                            "ends before a page of its hierarchy does; only convert can read it, as LAZ");
        if (bytes == 0 || bytes % kEntryBytes != 0)
            return refused(file_, "has a hierarchy page that is no list of entries");
        const auto after = ends_.upper_bound(offset);  // the first page that ends after this one begins
        if (after != ends_.end() && after->second < offset + bytes)
            return refused(file_, "has hierarchy pages that overlap");
        ends_.emplace(offset + bytes, offset);
        pages_.push_back({offset, bytes});
        return {};
    }

    Result<void> read_page(Page page) {
        std::vector<std::byte> block(std::min(page.bytes, kBlockBytes));
        for (; page.bytes > 0; page.offset += block.size(), page.bytes -= block.size()) {
            block.resize(std::min<uint64_t>(page.bytes, block.size()));
            LUCARNE_TRY(file_.read_at(page.offset, block));
            for (size_t at = 0; at < block.size(); at += kEntryBytes) LUCARNE_TRY(add_entry(&block[at]));
        }
        return {};
    }

    Result<void> add_entry(const std::byte* at) {
        const std::array<int32_t, 4> key = {load<int32_t>(at), load<int32_t>(at + 4), load<int32_t>(at + 8),
                                            load<int32_t>(at + 12)};
        const auto offset = load<uint64_t>(at + 16);
        const auto bytes = load<int32_t>(at + 24), points = load<int32_t>(at + 28);
        const std::string name = fmt::format("{}-{}-{}-{}", key[0], key[1], key[2], key[3]);
        const auto inside = [&](int32_t cell) { return cell >= 0 && int64_t{cell} >> key[0] == 0; };
        if (key[0] < 0 || key[0] > int32_t{kMostLevel} || !inside(key[1]) || !inside(key[2]) ||
            !inside(key[3]))
            return refused(file_, fmt::format("has the node {}, which lies outside the root cube", name));
        if (bytes < 0 || points < kPage)
            return refused(file_, fmt::format("has the node {} with a negative size", name));
        if (points == kPage) return add_page(offset, static_cast<uint64_t>(bytes));
        Node node{{static_cast<uint32_t>(key[0]), static_cast<uint32_t>(key[1]),
                   static_cast<uint32_t>(key[2]), static_cast<uint32_t>(key[3])},
                  {}};
        if (points > 0) {
            node.chunk = {offset, static_cast<uint64_t>(bytes), static_cast<uint64_t>(points)};
            LUCARNE_TRY(check_chunk(node.chunk, name));
        }
        nodes_.push_back(node);
        return {};
    }

    Result<void> check_chunk(const laz::ChunkPlace& chunk, const std::string& name) {
        const uint64_t first = header_.points_offset + sizeof(uint64_t);
        if (chunk.offset < first || chunk.offset > file_.size() || chunk.bytes > file_.size() - chunk.offset)
            return refused(file_, fmt::format("has the node {}, whose points lie outside the file", name));
        if (chunk.points / las::kMostPointsAByte > chunk.bytes)
            return refused(file_, fmt::format("has the node {} of {} points, more than its {} bytes can hold",
                                              name, chunk.points, chunk.bytes));
        if (chunk.points * header_.record_length > kMostNodeBytes)
            return refused(file_, fmt::format("has the node {} of {} points, too large to be drawn", name,
                                              chunk.points));
        return {};
    }

    Result<void> check_chunks() {
        uint64_t points = 0;
        std::vector<Page> chunks;
        for (const Node& node : nodes_) {
            points += node.chunk.points;
            if (node.chunk.points > 0) chunks.push_back({node.chunk.offset, node.chunk.bytes});
        }
        if (points != header_.points)
            return refused(file_, fmt::format("has {} points in its hierarchy and {} in its header", points,
                                              header_.points));
        std::sort(chunks.begin(), chunks.end(),
                  [](const Page& a, const Page& b) { return a.offset < b.offset; });
        for (size_t i = 1; i < chunks.size(); ++i)
            if (chunks[i].offset - chunks[i - 1].offset < chunks[i - 1].bytes)
                return refused(file_, "has nodes whose points overlap");
        return {};
    }

    const ByteSource& file_;
    const las::Header& header_;
    std::vector<Page> pages_;
    std::map<uint64_t, uint64_t> ends_;  ///< end of each page, with its begin
    std::vector<Node> nodes_;
};

}  // namespace

Result<std::vector<Node>> read_hierarchy(const ByteSource& file, const las::Header& header,
                                         const Info& info) {
    return HierarchyReader(file, header).read(info);
}

}  // namespace lucarne::io::copc
