#pragma once

#include "io/formats/las/laz/models.h"

namespace lucarne::io::laz {

/// Maps a number of bits to a context: two neighbouring numbers share one, and all from `most` on share the
/// last.
inline uint32_t even_up_to(uint32_t k, uint32_t most) {
    return k < most ? k & ~1u : most;
}

/// Codes integers as differences from a prediction: first k, the number of bits of the difference, then its
/// upper eight bits with a model for each k, then the rest without a model. (Isenburg 2013, "integer
/// compressor".)
class IntegerModel {
 public:
    /// `bits` is the width: 8, 16 or 32. `contexts` is the number of contexts for k.
    explicit IntegerModel(uint32_t bits, uint32_t contexts = 1)
        : bits_(bits), k_models_(contexts, SymbolModel(bits + 1)) {
        for (uint32_t k = 1; k <= bits; ++k) high_models_.emplace_back(1u << (k < kHighBits ? k : kHighBits));
    }

    /// Codes a value and returns it. A decoder ignores `value`. Values of less than 32 bits are not negative.
    template <class Coder>
    int32_t code(Coder& coder, int32_t expected, int32_t value, uint32_t context = 0) {
        const int64_t range = int64_t{1} << bits_;
        int64_t off = 0;
        if constexpr (Coder::kEncodes) {
            off = int64_t{value} - expected;
            if (off < -range / 2) off += range;
            if (off >= range / 2) off -= range;
        }
        off = difference(coder, off, context);
        const int64_t result = int64_t{expected} + off;
        if (bits_ == 32) return static_cast<int32_t>(static_cast<uint32_t>(result));
        return static_cast<int32_t>(result < 0 ? result + range : result >= range ? result - range : result);
    }
    /// Returns how many bits the difference of the last value took.
    uint32_t k() const { return k_; }

 private:
    static constexpr uint32_t kHighBits = 8;

    static uint32_t bits_of(int64_t off) {
        uint32_t k = 0;
        for (int64_t rest = off <= 0 ? -off : off - 1; rest > 0; rest >>= 1) ++k;
        return k;
    }

    /// k bits cover [-(2^k - 1), -2^(k-1)] and [2^(k-1) + 1, 2^k]; k = 0 covers 0 and 1.
    template <class Coder>
    int64_t difference(Coder& coder, int64_t off, uint32_t context) {
        k_ = coder.symbol(k_models_[context], Coder::kEncodes ? bits_of(off) : 0);
        if (k_ == 0) return coder.bit(lowest_, static_cast<uint32_t>(off));
        if (k_ >= 32) return INT32_MIN;
        const int64_t span = (int64_t{1} << k_) - 1;
        const auto place = static_cast<uint32_t>(off < 0 ? off + span : off - 1);
        const uint32_t low_bits = k_ > kHighBits ? k_ - kHighBits : 0;
        uint32_t found = coder.symbol(high_models_[k_ - 1], place >> low_bits);
        if (low_bits) found = found << low_bits | coder.bits(low_bits, place & ((1u << low_bits) - 1));
        return found >= 1u << (k_ - 1) ? int64_t{found} + 1 : int64_t{found} - span;
    }

    uint32_t bits_, k_ = 0;
    std::vector<SymbolModel> k_models_, high_models_;
    BitModel lowest_;
};

}  // namespace lucarne::io::laz
