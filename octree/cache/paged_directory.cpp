#include "octree/cache/paged_directory.h"

#include <algorithm>
#include <cassert>
#include <utility>

#include <fmt/format.h>

#include "io/core/log.h"
#include "octree/cache/checked_read.h"

namespace lucarne::octree {

using format::Page;

Result<std::unique_ptr<PagedDirectory>> PagedDirectory::open(const ByteSource& file,
                                                             const format::Superblock& block,
                                                             const SourceHeader& header,
                                                             const PayloadReader& reader, uint64_t memory) {
    LUCARNE_ASSIGN(auto pages, read_pages(file, block, *header.directory_pages));
    std::unique_ptr<PagedDirectory> directory(
        new PagedDirectory(file, block, header, reader, std::move(pages), memory));
    LUCARNE_ASSIGN(const CheckedNode root, directory->find(0));
    if (root.info.key != NodeKey{}) return damaged(file, "it has no root node");
    if (root.info.subtree_count != header.points)
        return damaged(file, "metadata and directory disagree about the number of points");
    return directory;
}

PagedDirectory::PagedDirectory(const ByteSource& file, const format::Superblock& block,
                               const SourceHeader& header, const PayloadReader& reader,
                               std::vector<Page> pages, uint64_t memory)
    : file_(file),
      directory_offset_(block.directory_offset),
      nodes_(static_cast<uint32_t>(block.directory_bytes / format::kEntryBytes)),
      page_nodes_(header.directory_pages->nodes),
      check_(file, block, header, reader),
      pages_(std::move(pages)),
      most_held_(std::max(kLeastPages, memory / (page_nodes_ * kNodeBytes))) {}

uint64_t PagedDirectory::most_bytes() const {
    return pages_.size() * sizeof(Page) + most_held_ * page_nodes_ * kNodeBytes;
}

size_t PagedDirectory::held() const {
    const std::lock_guard lock(mutex_);
    return held_.size();
}

Result<void> PagedDirectory::state() const {
    const std::lock_guard lock(mutex_);
    if (error_) return tl::make_unexpected(*error_);
    return {};
}

NodeInfo PagedDirectory::node(uint32_t index) const {
    auto found = find(index);
    if (found) return found->info;
    const std::lock_guard lock(mutex_);
    if (!error_) {
        log::warn("{}; what lies there is missing", found.error().line());
        error_ = std::move(found).error();
    }
    return {};
}

Result<CheckedNode> PagedDirectory::find(uint32_t index) const {
    assert(index < nodes_);
    LUCARNE_ASSIGN(const auto nodes, page(index / page_nodes_));
    return (*nodes)[index % page_nodes_];
}

std::shared_ptr<const PagedDirectory::Nodes> PagedDirectory::held_page(size_t number) const {
    const std::lock_guard lock(mutex_);
    const auto found = held_.find(number);
    if (found == held_.end()) return nullptr;
    found->second.last_used = ++uses_;
    return found->second.nodes;
}

/// Returns a page. Another thread may read the same page at the same time; then one of the copies is kept.
Result<std::shared_ptr<const PagedDirectory::Nodes>> PagedDirectory::page(size_t number) const {
    if (auto held = held_page(number)) return held;
    LUCARNE_ASSIGN(Nodes nodes, read(number));
    LUCARNE_TRY(find_parents(number, nodes));
    auto made = std::make_shared<const Nodes>(std::move(nodes));
    const std::lock_guard lock(mutex_);
    while (held_.size() >= most_held_)
        held_.erase(
            std::ranges::min_element(held_, {}, [](const auto& held) { return held.second.last_used; }));
    held_[number] = {made, ++uses_};
    return made;
}

/// Where the numbers of the children of a page's nodes end.
uint32_t PagedDirectory::end_of_children(size_t number) const {
    return number + 1 < pages_.size() ? pages_[number + 1].first_child : nodes_;
}

/// Reads a page's nodes with their children, but without their parents.
Result<PagedDirectory::Nodes> PagedDirectory::read(size_t number) const {
    const uint32_t first = static_cast<uint32_t>(number) * page_nodes_;
    const uint32_t count = std::min(page_nodes_, nodes_ - first);
    LUCARNE_ASSIGN(const auto bytes,
                   read_checked(file_, directory_offset_ + uint64_t{first} * format::kEntryBytes,
                                count * format::kEntryBytes, pages_[number].checksum,
                                fmt::format("page {} of its directory", number)));
    Nodes nodes;
    nodes.reserve(count);
    uint64_t next = pages_[number].first_child;
    for (uint32_t i = 0; i < count; ++i) {
        LUCARNE_ASSIGN(CheckedNode node, check_.load(first + i, &bytes[i * format::kEntryBytes]));
        const uint32_t mask = node.info.child_mask;
        if (mask != 0) {
            node.info.first_child = static_cast<uint32_t>(next);
            next += static_cast<uint32_t>(__builtin_popcount(mask));
            if (node.info.first_child <= first + i || next > end_of_children(number))
                return damaged(file_,
                               fmt::format("the children of node {} are not where they belong", first + i));
        }
        nodes.push_back(node);
    }
    if (next != end_of_children(number))
        return damaged(file_, fmt::format("page {} of its directory does not fit the next one", number));
    return nodes;
}

/// Gives a page's nodes their parents. These are in one page or in few that follow each other, because both
/// levels are in the same order.
Result<void> PagedDirectory::find_parents(size_t number, Nodes& nodes) const {
    const uint32_t first = static_cast<uint32_t>(number) * page_nodes_;
    const auto last = static_cast<uint32_t>(first + nodes.size());
    uint32_t child = std::max(first, 1u);  // the root has none
    while (child < last) {
        const auto after = std::ranges::upper_bound(pages_, child, {}, &Page::first_child);
        const auto above = static_cast<size_t>(after - pages_.begin()) - 1;
        std::shared_ptr<const Nodes> parents = above == number ? nullptr : held_page(above);
        if (!parents && above != number) {
            LUCARNE_ASSIGN(Nodes read_now, read(above));
            parents = std::make_shared<const Nodes>(std::move(read_now));
        }
        const Nodes& from = parents ? *parents : nodes;
        for (uint32_t i = 0; i < from.size(); ++i) {
            const NodeInfo parent = from[i].info;
            for (uint32_t octant = 0; octant < 8 && child < last; ++octant) {
                if (parent.child(octant) != child) continue;
                NodeInfo& info = nodes[child - first].info;
                if (info.key != parent.key.child(octant))
                    return damaged(file_, fmt::format("the children of node {} are not where they belong",
                                                      above * page_nodes_ + i));
                info.parent = static_cast<uint32_t>(above * page_nodes_ + i);
                ++child;
            }
        }
        if (child < std::min(last, end_of_children(above)))
            return damaged(file_, fmt::format("node {} has no parent", child));
    }
    return {};
}

}  // namespace lucarne::octree
