#include "io/formats/common/value_range.h"

#include <cmath>

#include <nlohmann/json.hpp>

namespace lucarne::io {

std::optional<Range> stated_range(const nlohmann::json& details) {
    const auto limits =
        details.is_object() ? details.value(kIntensityLimits, nlohmann::json()) : nlohmann::json();
    if (!limits.is_array() || limits.size() != 2 || !limits[0].is_number() || !limits[1].is_number())
        return std::nullopt;
    const Range range{limits[0].get<double>(), limits[1].get<double>()};
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
