#pragma once

#include <vector>

#include "octree/cache/payload.h"

namespace lucarne::octree {

/// A node as its entry in the directory describes it, without its place in the tree.
struct CheckedNode {
    NodeInfo info;
    StoredPayload payload;
};
/// Bytes of memory that a node takes.
inline constexpr size_t kNodeBytes = sizeof(NodeInfo) + sizeof(StoredPayload);

/// Checks entries of the directory by themselves: cube, codec, layout, and its points' place and size in the
/// file.
class EntryCheck {
 public:
    EntryCheck(const ByteSource& file, const format::Superblock& block, const SourceHeader& header,
               const PayloadReader& reader)
        : file_(file), end_(block.file_bytes), points_(header.points), reader_(reader) {}
    /// Loads the entry of node `index`, 64 bytes at `at`.
    Result<CheckedNode> load(uint32_t index, const std::byte* at) const;

 private:
    const ByteSource& file_;
    uint64_t end_, points_;
    const PayloadReader& reader_;
};

/// Bytes that the pages of a directory of so many nodes take in the file.
uint64_t pages_bytes(uint64_t nodes, uint32_t page_nodes);
/// Makes the pages of a directory.
class PageList {
 public:
    /// Takes the next page's entries.
    void add(std::span<const std::byte> entries);
    const std::vector<format::Page>& pages() const { return pages_; }

 private:
    std::vector<format::Page> pages_;
    uint32_t next_child_ = 1;
};
std::vector<format::Page> pages_of(std::span<const std::byte> directory, uint32_t page_nodes);
/// Reads and checks what the file states about the pages. Errors: a wrong place, size or checksum; pages that
/// cannot be those of a breadth-first directory.
Result<std::vector<format::Page>> read_pages(const ByteSource& file, const format::Superblock& block,
                                             const DirectoryPages& pages);

}  // namespace lucarne::octree
