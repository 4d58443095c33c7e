#pragma once

#include <cstdint>
#include <memory>

#include "io/points.h"

namespace lucarne::io {

/// A scan of which several processes can each read a part. It is a PointSource as well. Its points are
/// counted as info().declared_points does, and none is dropped.
class DivisibleSource {
 public:
    virtual ~DivisibleSource() = default;
    /// Returns the last point, at `point` or before it, where a part can begin; 0 if the scan cannot be
    /// divided. Errors: unreadable.
    virtual Result<uint64_t> cut(uint64_t point) const = 0;
    /// Starts a pass over the points [first, end), which cut() returned; `end` may also be the number of
    /// points. Errors: unreadable; not such a place.
    virtual Result<std::unique_ptr<PointReader>> open_part(uint64_t first, uint64_t end) const = 0;
};

}  // namespace lucarne::io
