#include "octree/stations/scan_runs.h"

#include <algorithm>

namespace lucarne::octree {

ScanRuns::ScanRuns(uint64_t first, uint64_t points, const glm::dvec3& origin)
    : origin_(origin), seen_(first) {
    // A scan halves its runs when a point comes behind the last run that it can keep.
    while (points > ((kMostRuns - 1) * stride_ + 1) * kRunPoints) stride_ *= 2;
}

void ScanRuns::join(std::span<const glm::vec3> points, uint64_t count) {
    points_.insert(points_.end(), points.begin(), points.end());
    seen_ += count;
}

void ScanRuns::add(const io::Schema& schema, std::span<const std::byte> records) {
    const uint64_t count = records.size() / schema.stride;
    if (seen_ == 0 && count > 0) origin_ = io::position_of(schema, records.data());
    const uint64_t end = seen_ + count;
    for (uint64_t at = seen_; at < end;) {
        const uint64_t run = at / kRunPoints, last = std::min((run + 1) * kRunPoints, end);
        if (at % kRunPoints == 0 && points_.size() == kMostRuns * kRunPoints) halve();
        if (run % stride_ != 0) {
            at = (run / stride_ + 1) * stride_ * kRunPoints;
            continue;
        }
        for (; at < last; ++at)
            points_.emplace_back(io::position_of(schema, &records[(at - seen_) * schema.stride]) - origin_);
    }
    seen_ = end;
}

void ScanRuns::halve() {
    for (size_t run = 1; run < kMostRuns / 2; ++run)
        std::copy_n(points_.begin() + static_cast<ptrdiff_t>(2 * run * kRunPoints), kRunPoints,
                    points_.begin() + static_cast<ptrdiff_t>(run * kRunPoints));
    points_.resize(kMostRuns / 2 * kRunPoints);
    stride_ *= 2;
}

}  // namespace lucarne::octree
