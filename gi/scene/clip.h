#pragma once

#include <cstddef>
#include <cstdint>
#include <vector>

#include <glm/vec3.hpp>

#include "gi/shared/clip.h"
#include "octree/tree/key.h"

namespace lucarne::gi {

/// World units and radians. Keeps the points inside, or with `inverted` those outside.
struct ClipBox {
    glm::dvec3 min{0.0}, max{1.0};
    double rotation = 0;  ///< about the vertical through its middle, counterclockwise from above
    bool inverted = false;
    bool operator==(const ClipBox&) const = default;
};

/// Keeps the points on the side that the normal points to, and those on the plane.
struct ClipPlane {
    glm::dvec3 position{0.0}, normal{0.0, 0.0, 1.0};
    bool inverted = false;  ///< the other side
    bool operator==(const ClipPlane&) const = default;
};

/// A point is kept that lies in one of the boxes (where there are any that are not inverted), in no inverted
/// box, and on the kept side of every plane.
struct Clip {
    std::vector<ClipBox> boxes;
    std::vector<ClipPlane> planes;
    bool casts = false;  ///< what is clipped is out of sight, but still blocks and bounces light
    bool active() const { return !boxes.empty() || !planes.empty(); }
    bool operator==(const Clip&) const = default;
};
inline constexpr size_t kMostClips = 64;  ///< boxes and planes together

/// A clip as devices test points against it: metres, relative to a local origin.
struct DeviceClip {
    std::vector<ClipShape> shapes;
    bool keeps(const glm::vec3& point) const;
};
DeviceClip device_clip(const Clip& clip, const glm::dvec3& local_origin, double metres_per_unit);

/// Where a cube in world units stands: every point in it is kept, none is, or it takes a test. Only `some`
/// may be said too often.
enum class Kept : uint8_t { none, some, all };
Kept kept(const Clip& clip, const octree::Cube& cube);

}  // namespace lucarne::gi
