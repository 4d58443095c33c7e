#pragma once

#include <array>
#include <chrono>
#include <cstddef>
#include <cstdint>
#include <deque>
#include <string>

namespace lucarne::viewer {

/// The window's own frames, beside the pictures': how long each kept the window from answering.
class FrameTimes {
 public:
    void add(double seconds);
    size_t frames() const { return frames_; }  ///< since the start
    /// Seconds that this share of the last frames did not exceed (0.5: the median); 0 before the first.
    double quantile(double share) const;

 private:
    static constexpr size_t kKept = 240;  ///< four seconds of motion
    std::array<double, kKept> last_{};
    size_t frames_ = 0;
};

/// Bounds how often a lost device is set up again: what is lost each time would go on for ever.
class RecoveryTries {
 public:
    using Clock = std::chrono::steady_clock;
    static constexpr size_t kMost = 3;
    static constexpr std::chrono::seconds kSpan{60};

    /// Counts a try at `now`; false, and nothing is counted, where there were kMost within kSpan before.
    bool take(Clock::time_point now);

 private:
    std::deque<Clock::time_point> taken_;
};

/// What is wrong for as long as it is, and how the window keeps up.
struct Health {
    std::string device;   ///< the graphics device is lost for good; empty: it works
    std::string shaders;  ///< why the last good program is used instead of a shader file
    std::string nodes;    ///< what is left out of the picture, because it cannot be read
    FrameTimes frames;
    uint64_t shader_version = 0;  ///< counts wishes to read the shader files again
};

}  // namespace lucarne::viewer
