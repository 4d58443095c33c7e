#pragma once

#include <filesystem>
#include <string>
#include <vector>

#include "io/core/error.h"

namespace lucarne::viewer {

/// The part of a report that a comparison needs.
struct FlownReport {
    std::string engine, mode, preset;
    bool cold = false;
    std::vector<double> times, ms;  ///< for each frame: time on the path (s), frame time (ms)

    std::string name() const;
};

/// Reads the flights of a report that `lucarne fly` wrote. Errors (ErrorKind::input_rejected): the file is no
/// such report.
Result<std::vector<FlownReport>> read_flights(const std::filesystem::path& path);

enum class Verdict { faster, slower, same, unclear };

/// The ratio of B's frame times to A's.
struct FlightComparison {
    double ratio = 1, low = 1, high = 1;  ///< median, and its 95 % confidence interval
    double p = 1;                         ///< unpaired flights: two-sided p of Mann & Whitney's test
    bool paired = false;                  ///< frames at the same times on the path were compared
    Verdict verdict = Verdict::unclear;
};

/// Compares two flights. Frames at the same times are compared in pairs: the ratio is the median of the
/// pairs' ratios. Otherwise it is the ratio of the flights' medians, and the test of Mann & Whitney (1947)
/// must also find a difference. The confidence interval comes from a bootstrap over blocks of frames (Kuensch
/// 1989), since neighbouring frames are correlated. The verdict is faster or slower if the whole interval
/// lies beyond `margin` (usually .03, the noise of a quiet machine), and same if the whole interval lies
/// within it. The result is the same on every run.
FlightComparison compare_flights(const FlownReport& a, const FlownReport& b, double margin);

/// Returns a sentence such as "B is 12.3 % slower than A (95 % confidence 10.1 to 14.2 %; 120 frames in
/// pairs)".
std::string verdict_text(const FlightComparison& comparison, const FlownReport& a, const FlownReport& b);

}  // namespace lucarne::viewer
