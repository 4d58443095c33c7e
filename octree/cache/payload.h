#pragma once

#include <memory>
#include <optional>
#include <string>
#include <vector>

#include "io/files/byte_source.h"
#include "octree/cache/format.h"
#include "octree/cache/record_map.h"
#include "octree/codec/decoder_pool.h"

namespace lucarne::octree {

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

}  // namespace lucarne::octree
