#include "io/formats/las/laz/models.h"

#include <algorithm>

namespace lucarne::io::laz {
namespace {

constexpr uint32_t kMostCounts = 1u << kLengthShift, kMostBits = 1u << kBitLengthShift;
/// Up to this number of symbols, searching the whole range costs less than keeping a table.
constexpr uint32_t kFewSymbols = 16;

}  // namespace

SymbolModel::SymbolModel(uint32_t symbols)
    : symbols_(symbols), cycle_(symbols), begins_(symbols), counts_(symbols, 1) {
    if (symbols > kFewSymbols) {
        uint32_t bits = 3;
        while (symbols > 1u << (bits + 2)) ++bits;
        part_shift_ = kLengthShift - bits;
        first_.resize((1u << bits) + 2);
    }
    update();
    until_update_ = cycle_ = (symbols + 6) / 2;
}

void SymbolModel::update() {
    total_ += cycle_;
    if (total_ > kMostCounts) {
        total_ = 0;
        for (auto& count : counts_) total_ += count = static_cast<uint16_t>((count + 1) / 2);
    }
    const uint32_t scale = 0x80000000u / total_;
    uint32_t sum = 0, part = 0;
    for (uint32_t symbol = 0; symbol < symbols_; ++symbol) {
        begins_[symbol] = static_cast<uint16_t>((scale * sum) >> (31 - kLengthShift));
        sum += counts_[symbol];
        if (first_.empty()) continue;
        for (const uint32_t last = begins_[symbol] >> part_shift_; part < last;)
            first_[++part] = static_cast<uint16_t>(symbol - 1);
    }
    if (!first_.empty()) {
        first_[0] = 0;
        std::fill(first_.begin() + part + 1, first_.end(), static_cast<uint16_t>(symbols_ - 1));
    }
    until_update_ = cycle_ = std::min(5 * cycle_ / 4, 8 * (symbols_ + 6));
}

void BitModel::update() {
    total_ += cycle_;
    if (total_ > kMostBits) {
        total_ = (total_ + 1) / 2;
        zeros_ = (zeros_ + 1) / 2;
        if (zeros_ == total_) ++total_;
    }
    zero_ = (zeros_ * (0x80000000u / total_)) >> (31 - kBitLengthShift);
    until_update_ = cycle_ = std::min(5 * cycle_ / 4, 64u);
}

}  // namespace lucarne::io::laz
