#pragma once

#include <algorithm>
#include <cassert>
#include <chrono>
#include <cstddef>
#include <utility>
#include <vector>

namespace lucarne::bench {

/// Returns the value below which this share of the values lies. `values` must not be empty.
inline double quantile(std::vector<double> values, double share) {
    assert(!values.empty());
    const auto at = static_cast<size_t>(share * static_cast<double>(values.size()));
    const auto nth = values.begin() + static_cast<std::ptrdiff_t>(std::min(at, values.size() - 1));
    std::nth_element(values.begin(), nth, values.end());
    return *nth;
}

/// Returns the upper median.
inline double median(std::vector<double> values) {
    return quantile(std::move(values), 0.5);
}

/// Calls `work` and returns how long it took, ms.
template <class Work>
double milliseconds_of(const Work& work) {
    const auto start = std::chrono::steady_clock::now();
    work();
    return 1e3 * std::chrono::duration<double>(std::chrono::steady_clock::now() - start).count();
}

}  // namespace lucarne::bench
