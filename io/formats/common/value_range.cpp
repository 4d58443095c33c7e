#include "io/formats/common/value_range.h"

#include <cmath>

namespace lucarne::io {

std::optional<Range> stated_range(const FormatNotes& notes) {
    if (!notes.intensity_limits) return std::nullopt;
    const Range range{notes.intensity_limits->low, notes.intensity_limits->high};
    const double width = range.high - range.low;
    if (!(width > 1e-300) || !std::isfinite(width)) return std::nullopt;
    return range;
}

bool RangeSearch::add(std::span<const std::byte> records) {
    for (size_t at = 0; at < records.size(); at += stride_) {
        const double value = scalar_at(attribute_.type, &records[at + attribute_.offset]);
        if (!std::isfinite(value)) continue;
        low_ = any_ ? std::min(low_, value) : value;
        high_ = any_ ? std::max(high_, value) : value;
        any_ = true;
        whole_ = whole_ && value == std::nearbyint(value);
    }
    return true;
}

std::optional<Range> RangeSearch::found() const {
    const bool fits = whole_ && low_ >= 0 && high_ <= 65535;
    const double width = high_ - low_;
    if (fits || !(width > 1e-300) || !std::isfinite(width)) return std::nullopt;
    return Range{low_, high_};
}

}  // namespace lucarne::io
