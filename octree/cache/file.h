#pragma once

#include <array>
#include <filesystem>
#include <memory>
#include <optional>
#include <utility>
#include <vector>

#include "io/files/file.h"
#include "octree/cache/format.h"
#include "octree/cache/metadata.h"
#include "octree/cache/record_map.h"
#include "octree/codec/decoder_pool.h"

namespace lucarne::octree {

/// Returns both superblocks of a file; a damaged one is empty.
Result<std::array<std::optional<format::Superblock>, 2>> read_superblocks(const ByteSource& file);

/// Where a node's points are stored, and how.
struct StoredPayload {
    uint64_t offset = 0, checksum = 0;
    uint8_t codec = format::kCodecRaw, layout = 0;
};
/// Reads, checks and decodes a node's points (kNoNode: synthetic surfels, which errors call so), in the
/// layout in which they are stored. The node's sizes must have been checked against the file.
Result<NodeData> load_payload(const ByteSource& file, uint32_t node, const NodeInfo& info,
                              const StoredPayload& payload, codec::DecoderPool& decoders, uint32_t stride);

/// Loads payloads of any of a cache's layouts as records of its schema. Thread-safe.
class PayloadReader {
 public:
    /// Errors: a layout that does not fit into the schema. `name` is the cache's name in errors.
    static Result<PayloadReader> create(const std::string& name, const SourceHeader& header);

    size_t layouts() const { return layouts_.size(); }  ///< with the schema itself, which is the first
    uint32_t stride(uint8_t layout) const { return layouts_[layout].stride; }
    /// Loads a node; see load_payload.
    Result<NodeData> load(const ByteSource& file, uint32_t node, const NodeInfo& info,
                          const StoredPayload& payload) const;

 private:
    struct Layout {
        uint32_t stride = 0;
        std::unique_ptr<codec::DecoderPool> decoders;
        std::optional<RecordMap> to_schema;  ///< empty for the cache's own schema
    };
    std::vector<Layout> layouts_;
};

/// An open cache. Its directory is in memory, its points are in the file.
class CacheFile final : public NodeSource {
 public:
    static Result<std::unique_ptr<CacheFile>> open(std::shared_ptr<const ByteSource> file);
    static Result<std::unique_ptr<CacheFile>> open(const std::filesystem::path& path);

    const SourceHeader& header() const override { return header_; }
    std::span<const NodeInfo> nodes() const override { return nodes_; }
    uint64_t directory_bytes() const override {
        return nodes().size_bytes() + payloads_.size() * sizeof(StoredPayload);
    }
    Result<NodeData> load(uint32_t node) const override;
    std::optional<SourceIdentity> identity() const override;
    Result<std::vector<Filling>> fillings() const override;

    /// Loads the records of all synthetic surfels, in the schema of header().filling; empty if there are
    /// none.
    Result<NodeData> load_filling() const;
    /// Returns a node's directory entry.
    format::Entry entry(uint32_t node) const;
    const ByteSource& file() const { return *file_; }
    const format::Superblock& superblock() const { return block_; }

 private:
    CacheFile(std::shared_ptr<const ByteSource> file, const format::Superblock& block)
        : file_(std::move(file)), block_(block) {}
    Result<void> read_directory();
    Result<void> check_structure();
    Result<void> check_payloads();

    std::shared_ptr<const ByteSource> file_;
    format::Superblock block_;
    SourceHeader header_;
    std::vector<NodeInfo> nodes_;
    std::vector<StoredPayload> payloads_;
    PayloadReader reader_;
};

}  // namespace lucarne::octree
