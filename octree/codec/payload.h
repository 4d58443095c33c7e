#pragma once

#include <span>
#include <vector>

#include "octree/codec/column.h"
#include "octree/codec/layout.h"

namespace lucarne::octree::codec {

/// The largest node that is compressed, bytes of its records: what a reader must be ready to give for one.
inline constexpr uint64_t kMostRecordBytes = uint64_t{16} << 20;

/// Compressed payloads: codec 1 of octree/FORMAT.md. Not thread-safe: one for each thread.
class PayloadEncoder {
 public:
    explicit PayloadEncoder(const io::Schema& schema)
        : columns_(columns_of(schema)), stride_(schema.stride) {}

    /// Appends the payload of a node whose records come in an order where neighbours are near (along the
    /// Morton curve), each with its pass, from which the prefix order follows (append_prefix_order).
    void encode(std::span<const std::byte> records, std::span<const uint8_t> passes,
                std::vector<std::byte>& payload);

 private:
    std::vector<Column> columns_;
    uint32_t stride_;
    ColumnEncoder encoder_;
    std::vector<uint64_t> values_;
    std::vector<std::byte> bodies_;
};

/// Decodes payloads into records in prefix order. Not thread-safe: one for each thread.
class PayloadDecoder {
 public:
    explicit PayloadDecoder(std::span<const Column> columns, uint32_t stride)
        : columns_(columns), stride_(stride) {}

    /// `payload` is followed by kReadAhead readable bytes; `records` has room for all and is at most
    /// kMostRecordBytes. False where the payload is damaged.
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
