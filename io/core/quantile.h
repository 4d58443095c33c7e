#pragma once

#include <algorithm>
#include <cmath>
#include <cstddef>
#include <span>

namespace lucarne {

/// Returns the smallest value such that at least `share` (0 to 1) of the values do not exceed it: the nearest
/// rank (Hyndman & Fan 1996, type 1). Reorders the values. Returns 0 if there are none.
inline double nearest_rank(std::span<double> values, double share) {
    if (values.empty()) return 0;
    const auto rank = static_cast<size_t>(std::ceil(share * static_cast<double>(values.size())));
    const auto nth =
        values.begin() + static_cast<std::ptrdiff_t>(std::clamp<size_t>(rank, 1, values.size()) - 1);
    std::nth_element(values.begin(), nth, values.end());
    return *nth;
}

}  // namespace lucarne
