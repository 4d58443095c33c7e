#pragma once

#include <memory>
#include <mutex>
#include <optional>
#include <unordered_map>
#include <vector>

#include "octree/cache/directory.h"

namespace lucarne::octree {

/// A directory of which only the pages that are looked at are in memory, the most recent ones. A page is
/// checked when it is read: its checksum, its entries, and that children and parents belong together. What
/// needs all pages at once is not checked: counts of subtrees, and payloads that overlap. Thread-safe.
class PagedDirectory final : public NodePages {
 public:
    /// Reads the list of pages. Keeps as many pages as fit into `memory` bytes with that list, at least
    /// kLeastPages. The arguments must outlive it.
    static Result<std::unique_ptr<PagedDirectory>> open(const ByteSource& file,
                                                        const format::Superblock& block,
                                                        const SourceHeader& header,
                                                        const PayloadReader& reader, uint64_t memory);
    static constexpr uint64_t kLeastPages = 8;

    NodeTable nodes() const { return {*this, nodes_}; }
    NodeInfo node(uint32_t index) const override;
    /// Errors: the node's page cannot be read, or is damaged.
    Result<CheckedNode> find(uint32_t index) const;
    /// Fails with the first error of node().
    Result<void> state() const;
    uint64_t most_bytes() const;
    /// Pages in memory.
    size_t held() const;

 private:
    using Nodes = std::vector<CheckedNode>;
    struct Held {
        std::shared_ptr<const Nodes> nodes;
        uint64_t last_used = 0;
    };

    PagedDirectory(const ByteSource& file, const format::Superblock& block, const SourceHeader& header,
                   const PayloadReader& reader, std::vector<format::Page> pages, uint64_t memory);
    Result<std::shared_ptr<const Nodes>> page(size_t number) const;
    std::shared_ptr<const Nodes> held_page(size_t number) const;
    Result<Nodes> read(size_t number) const;
    Result<void> find_parents(size_t number, Nodes& nodes) const;
    uint32_t end_of_children(size_t number) const;

    const ByteSource& file_;
    const uint64_t directory_offset_;
    const uint32_t nodes_, page_nodes_;
    const EntryCheck check_;
    const std::vector<format::Page> pages_;
    const size_t most_held_;

    mutable std::mutex mutex_;  // guards what follows
    mutable std::unordered_map<size_t, Held> held_;
    mutable uint64_t uses_ = 0;
    mutable std::optional<Error> error_;
};

}  // namespace lucarne::octree
