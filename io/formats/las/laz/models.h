#pragma once

#include <cstdint>
#include <vector>

// Adaptive models of LAZ's arithmetic coder. Sources: A. Said, "Introduction to Arithmetic Coding - Theory
// and Practice", HP Labs report HPL-2004-76, 2004; M. Isenburg, "LASzip: lossless compression of LiDAR data",
// 2013. The constants are part of the format.
namespace lucarne::io::laz {

inline constexpr uint32_t kLengthShift = 15;     ///< bits of a symbol's probability
inline constexpr uint32_t kBitLengthShift = 13;  ///< bits of a bit's probability

/// Counts how often each of up to 2048 symbols occurred, and derives the symbol's interval from that.
class SymbolModel {
 public:
    explicit SymbolModel(uint32_t symbols);

    uint32_t last_symbol() const { return symbols_ - 1; }
    /// Returns where a symbol's interval begins, of 2^15. The last symbol's interval ends at the top.
    uint32_t begin(uint32_t symbol) const { return begins_[symbol]; }
    /// Returns the symbol whose interval holds `value`. A value beyond the top gives the last symbol.
    uint32_t find(uint32_t value) const {
        uint32_t low = 0, high = symbols_;
        if (!first_.empty()) {
            const uint32_t part = value >> part_shift_;
            low = first_[part];
            high = first_[part + 1] + 1u;
        }
        while (high > low + 1) {
            const uint32_t middle = (low + high) / 2;
            (begins_[middle] > value ? high : low) = middle;
        }
        return low;
    }
    void count(uint32_t symbol) {
        ++counts_[symbol];
        if (--until_update_ == 0) update();
    }

 private:
    void update();

    uint32_t symbols_, total_ = 0, cycle_, until_update_ = 0, part_shift_ = 0;
    std::vector<uint16_t> begins_, counts_;
    /// The symbol at the start of each part of the range, where the search begins.
    std::vector<uint16_t> first_;
};

/// The same for one bit.
class BitModel {
 public:
    uint32_t zero() const { return zero_; }  ///< the probability of a 0, of 2^13
    void count(uint32_t bit) {
        zeros_ += 1 - bit;
        if (--until_update_ == 0) update();
    }

 private:
    void update();

    uint32_t zeros_ = 1, total_ = 2, zero_ = 1u << (kBitLengthShift - 1), cycle_ = 4, until_update_ = 4;
};

}  // namespace lucarne::io::laz
