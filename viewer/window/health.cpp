#include "viewer/window/health.h"

#include <algorithm>
#include <span>

#include "io/core/quantile.h"

namespace lucarne::viewer {

void FrameTimes::add(double seconds) {
    last_[frames_++ % kKept] = seconds;
}

double FrameTimes::quantile(double share) const {
    std::array<double, kKept> times = last_;
    return nearest_rank(std::span(times).first(std::min(frames_, kKept)), share);
}

bool RecoveryTries::take(Clock::time_point now) {
    while (!taken_.empty() && now - taken_.front() > kSpan) taken_.pop_front();
    if (taken_.size() >= kMost) return false;
    taken_.push_back(now);
    return true;
}

}  // namespace lucarne::viewer
