#include "viewer/window/health.h"

#include <algorithm>
#include <cmath>

namespace lucarne::viewer {

void FrameTimes::add(double seconds) {
    last_[frames_++ % kKept] = seconds;
}

double FrameTimes::quantile(double share) const {
    const size_t count = std::min(frames_, kKept);
    if (count == 0) return 0;
    std::array<double, kKept> sorted = last_;
    const auto rank = static_cast<size_t>(std::ceil(share * static_cast<double>(count)));
    const auto nth = sorted.begin() + static_cast<ptrdiff_t>(std::clamp<size_t>(rank, 1, count) - 1);
    std::nth_element(sorted.begin(), nth, sorted.begin() + static_cast<ptrdiff_t>(count));
    return *nth;
}

bool RecoveryTries::take(Clock::time_point now) {
    while (!taken_.empty() && now - taken_.front() > kSpan) taken_.pop_front();
    if (taken_.size() >= kMost) return false;
    taken_.push_back(now);
    return true;
}

}  // namespace lucarne::viewer
