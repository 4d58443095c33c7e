#pragma once

#include <cstdint>
#include <string>
#include <vector>

#include "gi/device/gl/device.h"

namespace lucarne::gi {

/// Times the passes of a frame. With timer queries a pass takes the longer of what the host needed to issue
/// it and what the device needed to run it, and passes may overlap. Without them (timers of software devices
/// return wrong values) the device finishes before and after each pass, and the clock on the wall counts.
/// OpenCL's work, which OpenGL's queries do not see, is waited for before and after each pass by either
/// clock, so that it counts in the pass that queued it.
class PassTimes {
 public:
    enum class Clock { queries, wall };
    explicit PassTimes(Device& device)
        : PassTimes(device, device.info().software ? Clock::wall : Clock::queries) {}
    PassTimes(Device& device, Clock clock) : device_(device), clock_(clock) {}
    ~PassTimes();
    PassTimes(const PassTimes&) = delete;
    PassTimes& operator=(const PassTimes&) = delete;

    /// Starts a pass; passes do not nest.
    void begin(std::string name);
    void end();
    /// Waits until the device has finished the frame and completes the times.
    void finish();

    struct Pass {
        std::string name;
        double seconds = 0;
    };
    /// The passes of the frame in their order; complete after finish().
    const std::vector<Pass>& passes() const { return passes_; }
    /// Starts the next frame.
    void clear();

 private:
    Device& device_;
    Clock clock_;
    std::string name_;
    double start_ = 0;  ///< s, wall clock
    std::vector<Pass> passes_;
    std::vector<uint32_t> queries_;  ///< two time stamps a pass, kept from frame to frame
    size_t resolved_ = 0;            ///< passes whose queries were read
};

}  // namespace lucarne::gi
