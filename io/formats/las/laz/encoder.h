#pragma once

#include <cstddef>
#include <vector>

#include "io/formats/las/laz/models.h"

namespace lucarne::io::laz {

/// The inverse of Decoder, with the same functions. Each returns the value that it was given.
class Encoder {
 public:
    static constexpr bool kEncodes = true;

    uint32_t symbol(SymbolModel& model, uint32_t symbol) {
        const uint32_t unit = length_ >> kLengthShift;
        const uint32_t begin = model.begin(symbol) * unit;
        narrow(begin, symbol == model.last_symbol() ? length_ : model.begin(symbol + 1) * unit);
        model.count(symbol);
        return symbol;
    }
    uint32_t bit(BitModel& model, uint32_t bit) {
        const uint32_t border = model.zero() * (length_ >> kBitLengthShift);
        if (bit)
            narrow(border, length_);
        else
            narrow(0, border);
        model.count(bit);
        return bit;
    }
    uint32_t bits(uint32_t count, uint32_t value) {
        if (count > kMostBitsAtOnce) {
            bits(16, value & 0xffff);
            bits(count - 16, value >> 16);
            return value;
        }
        const uint32_t unit = length_ >> count;
        narrow(value * unit, value * unit + unit);
        return value;
    }
    /// Writes the rest and returns the code. Nothing can be encoded afterwards.
    std::vector<std::byte> finish();

 private:
    static constexpr uint32_t kLeastLength = 1u << 24, kMostBitsAtOnce = 19;

    void narrow(uint32_t begin, uint32_t end) {
        const uint32_t before = base_;
        base_ += begin;
        if (base_ < before) carry();
        length_ = end - begin;
        for (; length_ < kLeastLength; length_ <<= 8) {
            bytes_.push_back(static_cast<std::byte>(base_ >> 24));
            base_ <<= 8;
        }
    }
    void carry();

    std::vector<std::byte> bytes_;
    uint32_t base_ = 0, length_ = 0xffffffff;
};

}  // namespace lucarne::io::laz
