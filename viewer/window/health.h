#pragma once

#include <array>
#include <chrono>
#include <cstddef>
#include <cstdint>
#include <deque>
#include <string>

namespace lucarne::viewer {

/// Times of events that repeat, for example of the window's own frames.
class FrameTimes {
 public:
    void add(double seconds);
    size_t frames() const { return frames_; }  ///< since the start
    /// Returns the quantile of the last frames' times, seconds (0.5: the median); 0 before the first frame.
    double quantile(double share) const;

 private:
    static constexpr size_t kKept = 240;  ///< four seconds of motion
    std::array<double, kKept> last_{};
    size_t frames_ = 0;
};

/// Limits how often a lost device is set up again, since a device that is lost every time would be set up for
/// ever.
class RecoveryTries {
 public:
    using Clock = std::chrono::steady_clock;
    static constexpr size_t kMost = 3;
    static constexpr std::chrono::seconds kSpan{60};

    /// Counts a try at `now`. Returns false and counts nothing if there were kMost tries within the last
    /// kSpan.
    bool take(Clock::time_point now);

 private:
    std::deque<Clock::time_point> taken_;
};

/// Current problems, and the window's frame times.
struct Health {
    std::string device;           ///< the graphics device is lost for good; empty: it works
    std::string shaders;          ///< why the last good program is used instead of a shader file
    std::string picture;          ///< why there is no new picture
    std::string nodes;            ///< nodes that are missing in the picture because they cannot be read
    FrameTimes frames;            ///< of the window itself: how long each kept it from responding
    FrameTimes pictures;          ///< between two pictures while something moves
    uint64_t shader_version = 0;  ///< counts requests to reload the shader files
};

}  // namespace lucarne::viewer
