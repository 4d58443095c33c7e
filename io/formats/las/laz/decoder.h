#pragma once

#include <cstddef>
#include <span>

#include "io/formats/las/laz/models.h"

namespace lucarne::io::laz {

/// Arithmetic decoder for a piece of memory (sources: models.h). It never reads beyond the end: it continues
/// with zeros and sets `failed`. Whatever the bytes are, value_ stays below length_, so every index that
/// follows from it is valid.
class Decoder {
 public:
    static constexpr bool kEncodes = false;

    Decoder() = default;
    explicit Decoder(std::span<const std::byte> bytes) : next_(bytes.data()), end_(next_ + bytes.size()) {
        for (int i = 0; i < 4; ++i) value_ = value_ << 8 | byte();
        if (value_ == length_) failed_ = true, --value_;
    }

    /// Decodes the next symbol. The second argument exists only because the encoder has one; it is ignored.
    uint32_t symbol(SymbolModel& model, uint32_t = 0) {
        const uint32_t unit = length_ >> kLengthShift;
        const uint32_t symbol = model.find(value_ / unit);
        const uint32_t begin = model.begin(symbol) * unit;
        const uint32_t end = symbol == model.last_symbol() ? length_ : model.begin(symbol + 1) * unit;
        narrow(begin, end);
        model.count(symbol);
        return symbol;
    }
    uint32_t bit(BitModel& model, uint32_t = 0) {
        const uint32_t border = model.zero() * (length_ >> kBitLengthShift);
        const uint32_t bit = value_ >= border;
        if (bit)
            narrow(border, length_);
        else
            narrow(0, border);
        model.count(bit);
        return bit;
    }
    /// Decodes up to 32 bits without a model, lowest bits first.
    uint32_t bits(uint32_t count, uint32_t = 0) {
        if (count > kMostBitsAtOnce) {
            const uint32_t low = bits(16);
            return low | bits(count - 16) << 16;
        }
        const uint32_t unit = length_ >> count;
        const uint32_t found = value_ / unit;
        value_ -= found * unit;
        length_ = unit;
        refill();
        if (found >> count != 0) failed_ = true;
        return found & ((1u << count) - 1);
    }
    bool failed() const { return failed_; }
    void fail() { failed_ = true; }  ///< marks the decoded data as invalid
    bool at_end() const { return next_ == end_; }
    /// Returns whether the code ends here with the bytes with which every encoder ends it (Encoder::finish).
    bool is_finished() const {
        if (failed_ || !at_end()) return false;
        uint32_t read = 0;  // the last four bytes, from which value_ was made
        for (int i = -4; i < 0; ++i) read = read << 8 | static_cast<uint32_t>(next_[i]);
        const bool long_interval = length_ > 2 * kLeastLength;
        const uint32_t last = read - value_ + (long_interval ? kLeastLength : kLeastLength / 2);
        return read == (last & (long_interval ? 0xff000000 : 0xffff0000));
    }
    /// Returns how far the decoder has read. After the last symbol that is the end of the code.
    const std::byte* position() const { return next_; }

 private:
    static constexpr uint32_t kLeastLength = 1u << 24, kMostBitsAtOnce = 19;

    uint32_t byte() {
        if (next_ != end_) return static_cast<uint32_t>(*next_++);
        failed_ = true;
        return 0;
    }
    void narrow(uint32_t begin, uint32_t end) {
        value_ -= begin;
        length_ = end - begin;
        refill();
    }
    void refill() {
        for (; length_ < kLeastLength; length_ <<= 8) value_ = value_ << 8 | byte();
    }

    const std::byte *next_ = nullptr, *end_ = nullptr;
    uint32_t value_ = 0, length_ = 0xffffffff;
    bool failed_ = false;
};

}  // namespace lucarne::io::laz
