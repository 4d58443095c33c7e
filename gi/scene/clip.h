#pragma once

#include <cstddef>
#include <cstdint>
#include <vector>

#include <glm/vec3.hpp>

#include "gi/shared/clip.h"
#include "octree/tree/key.h"

namespace lucarne::gi {

/// A box in world units. Keeps the points inside, or those outside if `inverted`.
struct ClipBox {
    glm::dvec3 min{0.0}, max{1.0};
    double rotation = 0;  ///< radians about the vertical through its middle, counterclockwise from above
    bool inverted = false;
    bool operator==(const ClipBox&) const = default;
};

/// A plane in world units. Keeps the points on the side that the normal points to and those on the plane.
struct ClipPlane {
    glm::dvec3 position{0.0}, normal{0.0, 0.0, 1.0};
    bool inverted = false;  ///< keeps the other side
    bool operator==(const ClipPlane&) const = default;
};

/// A point is kept if it lies in at least one box that is not inverted (if there are any), in no inverted
/// box, and on the kept side of every plane.
struct Clip {
    std::vector<ClipBox> boxes;
    std::vector<ClipPlane> planes;
    bool casts = false;  ///< clipped points are not drawn, but still block and bounce light
    bool active() const { return !boxes.empty() || !planes.empty(); }
    bool operator==(const Clip&) const = default;
};
inline constexpr size_t kMostClips = 64;  ///< boxes and planes together

/// Returns whether a point (world units) is kept.
bool keeps(const Clip& clip, const glm::dvec3& point);

/// A clip in the form in which devices test points: metres, relative to a local origin.
struct DeviceClip {
    std::vector<ClipShape> shapes;
    bool keeps(const glm::vec3& point) const;
};
DeviceClip device_clip(const Clip& clip, const glm::dvec3& local_origin, double metres_per_unit);

/// How many points of a cube in world units are kept: all, none, or some, which have to be tested. kept()
/// may return `some` where all or none would be right, never the reverse.
enum class Kept : uint8_t { none, some, all };
Kept kept(const Clip& clip, const octree::Cube& cube);

}  // namespace lucarne::gi
