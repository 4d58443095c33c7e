#pragma once

#include <array>
#include <compare>
#include <filesystem>
#include <memory>
#include <optional>
#include <utility>
#include <vector>

#include "io/files/file.h"
#include "octree/cache/cache.h"
#include "octree/cache/format.h"
#include "octree/cache/metadata.h"
#include "octree/cache/paged_directory.h"
#include "octree/cache/payload.h"

namespace lucarne::octree {

/// Returns both superblocks of a file; a damaged one is empty.
Result<std::array<std::optional<format::Superblock>, 2>> read_superblocks(const ByteSource& file);

/// Bytes [begin, end) of a file.
struct FileRange {
    uint64_t begin = 0, end = 0;
    auto operator<=>(const FileRange&) const = default;
};

/// An open cache. Its directory is in memory or, if it takes more than `directory_memory` and can be read
/// page by page, as much of it as that. Its points are in the file.
class CacheFile final : public NodeSource {
 public:
    static Result<std::unique_ptr<CacheFile>> open(std::shared_ptr<const ByteSource> file,
                                                   uint64_t directory_memory = kDirectoryMemory);
    static Result<std::unique_ptr<CacheFile>> open(const std::filesystem::path& path,
                                                   uint64_t directory_memory = kDirectoryMemory);

    const SourceHeader& header() const override { return header_; }
    NodeTable nodes() const override { return pages_ ? pages_->nodes() : NodeTable(nodes_); }
    Result<void> directory_state() const override { return pages_ ? pages_->state() : Result<void>(); }
    uint64_t directory_bytes() const override {
        return pages_ ? pages_->most_bytes() : nodes_.size() * kNodeBytes;
    }
    Result<NodeData> load(uint32_t node) const override;
    std::optional<SourceIdentity> identity() const override;
    Result<std::vector<Filling>> fillings() const override;

    /// Loads the records of all synthetic surfels, in the schema of header().filling; empty if there are
    /// none.
    Result<NodeData> load_filling() const;
    /// Returns a node's directory entry. The directory must be whole in memory.
    format::Entry entry(uint32_t node) const;
    /// Whether the directory is whole in memory.
    bool whole() const { return !pages_; }
    /// Returns where a node's points are stored.
    Result<FileRange> payload(uint32_t node) const;
    /// Checks that neither these payloads nor the cache's other parts overlap.
    Result<void> check_overlaps(std::vector<FileRange> payloads) const;
    const ByteSource& file() const { return *file_; }
    const format::Superblock& superblock() const { return block_; }

 private:
    CacheFile(std::shared_ptr<const ByteSource> file, const format::Superblock& block)
        : file_(std::move(file)), block_(block) {}
    Result<void> read_header();
    Result<void> read_directory();
    Result<void> check_structure();
    Result<void> check_pages(std::span<const std::byte> directory) const;

    std::shared_ptr<const ByteSource> file_;
    format::Superblock block_;
    SourceHeader header_;
    PayloadReader reader_;
    std::vector<NodeInfo> nodes_;          ///< empty if it is read page by page
    std::vector<StoredPayload> payloads_;  ///< likewise
    std::unique_ptr<PagedDirectory> pages_;
};

}  // namespace lucarne::octree
