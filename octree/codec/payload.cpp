#include "octree/codec/payload.h"

#include <algorithm>
#include <cassert>

#include "octree/tree/prefix_order.h"

namespace lucarne::octree::codec {
namespace {

/// Copies a record. Sizes from 16 to 32 bytes take two overlapping copies of 16, which is faster than a
/// memcpy of a size unknown to the compiler.
void copy_record(std::byte* to, const std::byte* from, size_t bytes) {
    if (bytes >= 16 && bytes <= 32) {
        std::memcpy(to, from, 16);
        std::memcpy(to + bytes - 16, from + bytes - 16, 16);
    } else {
        std::memcpy(to, from, bytes);
    }
}

}  // namespace

void PayloadEncoder::encode(std::span<const std::byte> records, std::span<const uint8_t> passes,
                            std::vector<std::byte>& payload) {
    assert(records.size() == passes.size() * stride_);
    bodies_.clear();
    values_.assign(passes.begin(), passes.end());
    encoder_.encode(values_, payload, bodies_);
    for (const Column& column : columns_) {
        gather(column, records, stride_, values_);
        encoder_.encode(values_, payload, bodies_);
    }
    payload.insert(payload.end(), bodies_.begin(), bodies_.end());
}

bool PayloadDecoder::decode(std::span<const std::byte> payload, std::span<std::byte> records) {
    assert(records.size() % stride_ == 0 && records.size() <= kMostRecordBytes);
    const size_t count = records.size() / stride_;
    std::vector<ColumnHead> heads;
    for (size_t i = 0; i <= columns_.size(); ++i) {
        const auto head = read_head(payload, count);
        if (!head) return false;
        heads.push_back(*head);
    }
    uint64_t bodies = 0;
    for (const auto& head : heads) {
        bodies += head.body_bytes(count);
        if (bodies > payload.size()) return false;
    }
    if (bodies != payload.size()) return false;

    const uint64_t pass_bytes = heads[0].body_bytes(count);
    if (!decoder_.decode(heads[0], payload.first(pass_bytes), count, values_)) return false;
    passes_.resize(count);
    for (size_t i = 0; i < count; ++i) {
        if (values_[i] > kLastPass) return false;
        passes_[i] = static_cast<uint8_t>(values_[i]);
    }
    order_.clear();
    append_prefix_order(passes_, 0, order_);
    assert(order_.size() == count);
    curve_.resize(records.size());
    if (!decode_columns(payload.subspan(pass_bytes), std::span(heads).subspan(1))) return false;
    std::byte* to = records.data();
    for (const uint32_t i : order_) {
        copy_record(to, &curve_[size_t{i} * stride_], stride_);
        to += stride_;
    }
    return true;
}

bool PayloadDecoder::decode_columns(std::span<const std::byte> bodies, std::span<const ColumnHead> heads) {
    const size_t count = curve_.size() / stride_;
    // Constant columns are written once, into a stamp that is copied into every record first.
    const auto stamped = [&](size_t i) {
        const auto kind = columns_[i].kind;
        return heads[i].method == Method::constant &&
               (kind == Column::Kind::integer || kind == Column::Kind::real);
    };
    std::vector<std::byte> stamp(stride_);
    for (size_t i = 0; i < columns_.size(); ++i)
        if (stamped(i)) scatter(columns_[i], {&heads[i].base, 1}, stamp, stride_);
    for (size_t i = 0; i < count; ++i) copy_record(&curve_[i * stride_], stamp.data(), stride_);
    for (size_t i = 0; i < columns_.size(); ++i) {
        if (stamped(i)) continue;
        const uint64_t bytes = heads[i].body_bytes(count);
        if (!decoder_.decode(heads[i], bodies.first(bytes), count, values_)) return false;
        bodies = bodies.subspan(bytes);
        scatter(columns_[i], values_, curve_, stride_);
    }
    return true;
}

}  // namespace lucarne::octree::codec
