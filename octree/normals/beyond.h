#pragma once

#include <cstdint>

namespace lucarne::octree {

/// What is beside the line at which a point's surface ends, seen from the side to which its normal points.
enum class Beyond : uint8_t {
    nothing,  ///< air: the border of a sheet, or of what stations saw
    falls,    ///< another surface, behind the plane: an outer edge
    rises,    ///< another surface, before the plane: a corner, where discs end behind the other side
};

/// Returns what is beside the line seen from the other side.
constexpr Beyond turned(Beyond beyond) {
    return beyond == Beyond::falls ? Beyond::rises : beyond == Beyond::rises ? Beyond::falls : beyond;
}

}  // namespace lucarne::octree
