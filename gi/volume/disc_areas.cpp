#include "gi/volume/disc_areas.h"

#include <cassert>

#include "gi/tracing/light_sampling.h"

namespace lucarne::gi::volume {

Polygon octagon_about(const Grid& grid, const glm::vec3& position, const glm::vec3& normal, float radius) {
    glm::vec3 u, v;
    tracing::frame_of(normal, u, v);
    const glm::vec3 middle = grid.place(position);
    const float reach = radius / grid.voxel;
    constexpr float kTangent = 0.41421356f;  // of 22.5 degrees: half a side of an octagon about a unit circle
    Polygon polygon;
    for (int i = 0; i < 8; ++i) {
        // Corners of the square that the disc touches, cut off: (1, t), (t, 1), (-t, 1), ...
        const float long_side = reach * (i >= 4 ? -1.0f : 1.0f), short_side = long_side * kTangent;
        const int k = i % 4;
        const float along = k == 0 ? long_side : k == 1 ? short_side : k == 2 ? -short_side : -long_side;
        const float across = k == 0 || k == 3 ? short_side : long_side;
        polygon.add(middle + u * along + v * across);
    }
    return polygon;
}

Polygon cut(const Polygon& polygon, int axis, float sign, float low) {
    // Sutherland & Hodgman 1974, "Reentrant polygon clipping", for one plane.
    Polygon kept;
    for (size_t i = 0; i < polygon.count; ++i) {
        const glm::vec3 &from = polygon.corners[i], &to = polygon.corners[(i + 1) % polygon.count];
        const float before = sign * from[axis] - low, after = sign * to[axis] - low;
        if (before >= 0) kept.add(from);
        if ((before >= 0) != (after >= 0)) kept.add(from + (to - from) * (before / (before - after)));
        assert(kept.count < Polygon::kMost);
    }
    return kept;
}

}  // namespace lucarne::gi::volume
