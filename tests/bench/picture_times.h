// Times between the pictures that a window shows while its scene turns.
#pragma once

#include <chrono>
#include <cstddef>
#include <fstream>
#include <regex>
#include <string>
#include <vector>

#include <fmt/format.h>

#include "io/core/error.h"
#include "tests/bench/quantile.h"

namespace lucarne::bench {

struct PictureTimes {
    size_t pictures = 0;
    double median = 0, p95 = 0;  ///< milliseconds from one picture to the next
};

/// Returns the time of the clock that swap_times.cpp uses.
inline double monotonic_seconds() {
    return std::chrono::duration<double>(std::chrono::steady_clock::now().time_since_epoch()).count();
}

inline constexpr size_t kFewest = 3;  ///< pictures that make a series
inline tl::unexpected<Error> too_few(size_t pictures) {
    return failed("the window", fmt::format("shows {} pictures while the scene turns", pictures));
}

/// Reads the times that swap_times.cpp has written to `file` and evaluates those from `begin` to `end`,
/// seconds of the monotonic clock. Error: fewer than kFewest.
inline Result<PictureTimes> times_of_swaps(const std::string& file, double begin, double end) {
    std::vector<double> gaps;
    std::ifstream in(file);
    double last = 0;
    size_t pictures = 0;
    for (double time = 0; in >> time;) {
        if (time < begin || time > end) continue;
        if (pictures++ > 0) gaps.push_back(1e3 * (time - last));
        last = time;
    }
    if (pictures < kFewest) return too_few(pictures);
    return PictureTimes{pictures, median(gaps), quantile(gaps, 0.95)};
}

/// Reads the last line of a log that says how fast pictures came while something moved in `lucarne view`.
/// Its window draws more often than pictures come, so that its swaps do not tell.
inline Result<PictureTimes> times_of_log(const std::string& log) {
    static const std::regex line(
        R"(while moving: (\d+) pictures, (\d+(?:\.\d+)?) ms apart, 95 % within (\d+(?:\.\d+)?) ms)");
    std::smatch last;
    for (std::sregex_iterator at(log.begin(), log.end(), line), end; at != end; ++at) last = *at;
    if (last.empty())
        return failed("lucarne view",
                      "logs no line \"while moving: N pictures, X ms apart, 95 % within Y ms\"");
    const size_t pictures = std::stoul(last[1]);
    if (pictures < kFewest) return too_few(pictures);
    return PictureTimes{pictures, std::stod(last[2]), std::stod(last[3])};
}

}  // namespace lucarne::bench
