#pragma once

#include <cstddef>
#include <cstdint>

#include "io/points.h"

namespace lucarne::octree {

/// The most scans whose numbers have 16 bits. A cache with more has numbers of 32 bits (FORMAT.md).
inline constexpr size_t kMostShortScans = 65535;
/// The most scans of a cache.
inline constexpr size_t kMostScans = 1'000'000;

/// Tells which input a record is from. An attribute `scan` of another shape than a converter writes counts as
/// absent.
class ScanNumber {
 public:
    explicit ScanNumber(const io::Schema& schema) {
        const io::Attribute* scan = schema.find(io::names::scan);
        if (!scan || scan->components != 1) return;
        wide_ = scan->type == io::ScalarType::u32;
        there_ = wide_ || scan->type == io::ScalarType::u16;
        offset_ = scan->offset;
    }
    /// Whether the records have the attribute; otherwise all are of scan 0.
    explicit operator bool() const { return there_; }
    /// The largest number that can be stored.
    uint32_t most() const { return wide_ ? UINT32_MAX : UINT16_MAX; }
    uint32_t of(const std::byte* record) const {
        if (!there_) return 0;
        return wide_ ? io::load<uint32_t>(record + offset_) : io::load<uint16_t>(record + offset_);
    }
    void store(std::byte* record, uint32_t scan) const {
        if (wide_)
            io::store(record + offset_, scan);
        else if (there_)
            io::store(record + offset_, static_cast<uint16_t>(scan));
    }

 private:
    bool there_ = false, wide_ = false;
    uint32_t offset_ = 0;
};

}  // namespace lucarne::octree
