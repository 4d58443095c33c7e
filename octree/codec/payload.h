#pragma once

#include <span>
#include <vector>

#include "octree/codec/column.h"
#include "octree/codec/layout.h"

namespace lucarne::octree::codec {

/// The largest node that is compressed, in bytes of its records. It limits the memory that a reader allocates
/// for one.
inline constexpr uint64_t kMostRecordBytes = uint64_t{16} << 20;

/// Encodes compressed payloads: codec 1 of octree/FORMAT.md. Not thread-safe: use one per thread.
class PayloadEncoder {
 public:
    explicit PayloadEncoder(const io::Schema& schema)
        : columns_(columns_of(schema)), stride_(schema.stride) {}

    /// Appends the payload of a node. Its records must be ordered so that neighbours are near each other
    /// (along the Morton curve). Each has its pass, from which the prefix order follows
    /// (append_prefix_order).
    void encode(std::span<const std::byte> records, std::span<const uint8_t> passes,
                std::vector<std::byte>& payload);

 private:
    std::vector<Column> columns_;
    uint32_t stride_;
    ColumnEncoder encoder_;
    std::vector<uint64_t> values_;
    std::vector<std::byte> bodies_;
};

/// Decodes payloads into records in prefix order. Not thread-safe: use one per thread.
class PayloadDecoder {
 public:
    explicit PayloadDecoder(std::span<const Column> columns, uint32_t stride)
        : columns_(columns), stride_(stride) {}

    /// `payload` must be followed by kReadAhead readable bytes. `records` has room for all records of the
    /// node, at most kMostRecordBytes. Returns false if the payload is damaged.
    bool decode(std::span<const std::byte> payload, std::span<std::byte> records);

 private:
    bool decode_columns(std::span<const std::byte> bodies, std::span<const ColumnHead> heads);

    std::span<const Column> columns_;
    uint32_t stride_;
    ColumnDecoder decoder_;
    std::vector<uint64_t> values_;
    std::vector<std::byte> curve_;  ///< the records along the curve
    std::vector<uint8_t> passes_;
    std::vector<uint32_t> order_;
};

}  // namespace lucarne::octree::codec
