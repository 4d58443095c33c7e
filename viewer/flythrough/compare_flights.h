#pragma once

#include <filesystem>
#include <string>
#include <vector>

#include "io/core/error.h"

namespace lucarne::viewer {

/// What a comparison needs of a report.
struct FlownReport {
    std::string engine, mode, preset;
    bool cold = false;
    std::vector<double> times, ms;  ///< of each frame: on the path (s), taken

    std::string name() const;
};

/// The flights of a report that `lucarne fly` wrote. Errors (ErrorKind::input_rejected): anything else.
Result<std::vector<FlownReport>> read_flights(const std::filesystem::path& path);

enum class Verdict { faster, slower, same, unclear };

/// How long B's frames took over A's.
struct FlightComparison {
    double ratio = 1, low = 1, high = 1;  ///< median, and its 95 % confidence interval
    double p = 1;                         ///< unpaired: two-sided, of Mann & Whitney's test
    bool paired = false;                  ///< frame by frame at the same times on the path
    Verdict verdict = Verdict::unclear;
};

/// Frames at the same times are compared in pairs: the median of their ratios. Otherwise the medians of both
/// flights, and Mann & Whitney (1947) must see a difference, too. The interval is from a bootstrap of blocks
/// of frames (Kuensch 1989), since neighbouring frames are alike. Faster and slower mean beyond `margin`
/// (.03: machines are never quieter) with the whole interval; the same, within it with the whole interval.
/// The same result on every run.
FlightComparison compare_flights(const FlownReport& a, const FlownReport& b, double margin);

/// "B is 12.3 % slower than A (95 % confidence 10.1 to 14.2 %; 120 frames in pairs)".
std::string verdict_text(const FlightComparison& comparison, const FlownReport& a, const FlownReport& b);

}  // namespace lucarne::viewer
