#pragma once

#include <bit>
#include <cassert>
#include <cstddef>
#include <cstdint>
#include <cstring>
#include <span>
#include <vector>

namespace lucarne::octree::codec {

/// Writes numbers as consecutive bits: each number's lowest bit first, into the lowest free bit of the bytes.
class BitWriter {
 public:
    explicit BitWriter(std::vector<std::byte>& out) : out_(out) {}
    /// Appends the lower `bits` bits of `value`; its other bits must be 0. At most 64.
    void put(uint64_t value, uint32_t bits) {
        assert(bits <= 64 && (bits == 64 || value >> bits == 0));
        held_ |= value << used_;
        if (used_ + bits < 64) {
            used_ += bits;
            return;
        }
        append(held_, 8);
        held_ = used_ ? value >> (64 - used_) : 0;
        used_ = used_ + bits - 64;
    }
    /// Pads the last byte with zeros: the next number starts a new byte.
    void flush() {
        append(held_, (used_ + 7) / 8);
        held_ = used_ = 0;
    }

 private:
    void append(uint64_t word, size_t bytes) {
        const size_t end = out_.size();
        out_.resize(end + bytes);
        if (bytes) std::memcpy(&out_[end], &word, bytes);
    }
    std::vector<std::byte>& out_;
    uint64_t held_ = 0;
    uint32_t used_ = 0;  ///< bits of `held_`, below 64
};

inline constexpr size_t kReadAhead = 16;  ///< readable bytes that a BitReader needs after its own

/// Reads what a BitWriter wrote. The caller must have checked that all of the bits are there.
class BitReader {
 public:
    explicit BitReader(const std::byte* at) : at_(at) {}
    uint64_t take(uint32_t bits) {
        const std::byte* byte = at_ + (position_ >> 3);
        const auto shift = static_cast<uint32_t>(position_ & 7);
        uint64_t word;
        std::memcpy(&word, byte, 8);
        word >>= shift;
        if (bits > 56 && shift) [[unlikely]]
            word |= static_cast<uint64_t>(byte[8]) << (64 - shift);
        position_ += bits;
        return bits == 64 ? word : word & ((uint64_t{1} << bits) - 1);
    }

 private:
    const std::byte* at_;
    uint64_t position_ = 0;
};

}  // namespace lucarne::octree::codec
