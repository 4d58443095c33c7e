#include "octree/cache/directory.h"

#include <algorithm>
#include <bit>
#include <cmath>

#include <fmt/format.h>

#include "octree/cache/checked_read.h"

namespace lucarne::octree {

using format::Entry;
using format::Page;

Result<CheckedNode> EntryCheck::load(uint32_t index, const std::byte* at) const {
    const Entry entry = format::load_entry(at);
    const auto wrong = [&](const char* text) {
        return damaged(file_, fmt::format(fmt::runtime(text), index));
    };
    if (entry.key.level > kMostLevel || ((entry.key.x | entry.key.y | entry.key.z) >> entry.key.level) != 0)
        return wrong("node {} lies outside the root cube");
    if (entry.codec > format::kCodecColumns)
        return damaged(file_, fmt::format("node {} uses the unknown codec {}", index, entry.codec));
    if (!std::all_of(entry.area_floor.begin(), entry.area_floor.end(),
                     [](float v) { return std::isfinite(v) && v >= 0; }))
        return wrong("node {} has an impossible area floor");
    if (entry.layout >= reader_.layouts())
        return damaged(file_, fmt::format("node {} has the unknown layout {}", index, entry.layout));
    if (entry.subtree_count < entry.count || entry.subtree_count > points_)
        return wrong("the counts below node {} do not add up");
    const uint64_t bytes = entry.payload_bytes;
    const uint64_t records = uint64_t{entry.count} * reader_.stride(entry.layout);
    const bool fits = entry.codec == format::kCodecRaw
                          ? bytes == records
                          : bytes < records && records <= codec::kMostRecordBytes;
    if (!fits) return wrong("node {} states a wrong size of its points");
    if (!inside(entry.payload_offset, bytes, end_))
        return wrong("the points of node {} lie outside the file");
    return CheckedNode{{.key = entry.key,
                        .child_mask = entry.child_mask,
                        .count = entry.count,
                        .subtree_count = entry.subtree_count,
                        .payload_bytes = entry.payload_bytes,
                        .area_floor = entry.area_floor},
                       {entry.payload_offset, entry.checksum, entry.codec, entry.layout}};
}

uint64_t pages_bytes(uint64_t nodes, uint32_t page_nodes) {
    return (nodes + page_nodes - 1) / page_nodes * format::kPageBytes;
}

void PageList::add(std::span<const std::byte> entries) {
    pages_.push_back({format::checksum(entries), next_child_});
    for (size_t at = 0; at < entries.size(); at += format::kEntryBytes)
        next_child_ += static_cast<uint32_t>(std::popcount(format::load_entry(&entries[at]).child_mask));
}

std::vector<Page> pages_of(std::span<const std::byte> directory, uint32_t page_nodes) {
    PageList list;
    const size_t step = page_nodes * format::kEntryBytes;
    for (size_t at = 0; at < directory.size(); at += step)
        list.add(directory.subspan(at, std::min(step, directory.size() - at)));
    return list.pages();
}

Result<std::vector<Page>> read_pages(const ByteSource& file, const format::Superblock& block,
                                     const DirectoryPages& pages) {
    const uint64_t nodes = block.directory_bytes / format::kEntryBytes;
    const uint64_t bytes = pages_bytes(nodes, pages.nodes);
    if (!inside(pages.offset, bytes, block.file_bytes))
        return damaged(file, "the pages of its directory lie outside the file");
    LUCARNE_ASSIGN(const auto stored, read_checked(file, pages.offset, bytes, pages.checksum,
                                                   "the list of its directory's pages"));
    std::vector<Page> list;
    list.reserve(bytes / format::kPageBytes);
    for (size_t at = 0; at < stored.size(); at += format::kPageBytes)
        list.push_back(format::load_page(&stored[at]));
    uint64_t before = 1;
    for (const Page& page : list) {
        if (page.first_child < before || page.first_child > nodes)
            return damaged(file, "the pages of its directory are in a wrong order");
        before = page.first_child;
    }
    if (!list.empty() && list.front().first_child != 1)
        return damaged(file, "the pages of its directory are in a wrong order");
    return list;
}

}  // namespace lucarne::octree
