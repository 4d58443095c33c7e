#include "gi/scene/clip.h"

#include <algorithm>
#include <array>
#include <cmath>

#include <glm/common.hpp>
#include <glm/geometric.hpp>

namespace lucarne::gi {
namespace {

using glm::dvec3;

struct BoxFrame {
    dvec3 centre;
    std::array<dvec3, 3> axes;  ///< along the box's axes, of length 1 / half the box's side
};

BoxFrame frame_of(const ClipBox& box) {
    constexpr double kThinnest = 1e-12;  // world units: a flat box keeps the points that lie on it
    const dvec3 half = glm::max((box.max - box.min) / 2.0, dvec3(kThinnest));
    const double c = std::cos(box.rotation), s = std::sin(box.rotation);
    return {(box.min + box.max) / 2.0,
            {dvec3(c, s, 0) / half.x, dvec3(-s, c, 0) / half.y, dvec3(0, 0, 1) / half.z}};
}

dvec3 kept_side(const ClipPlane& plane) {
    return glm::normalize(plane.inverted ? -plane.normal : plane.normal);
}

/// Returns how much of a cube lies in a box. May return `some` for cubes that only come close to the box.
Kept inside(const ClipBox& box, const octree::Cube& cube) {
    const BoxFrame frame = frame_of(box);
    const double half = cube.size / 2;
    const dvec3 centre = cube.min + half - frame.centre;
    Kept found = Kept::all;
    for (const dvec3& axis : frame.axes) {
        constexpr double kMargin = 1e-5;  // devices test in floats
        const double at = std::abs(glm::dot(axis, centre)),
                     reach = half * glm::dot(glm::abs(axis), dvec3(1.0)) + kMargin;
        if (at - reach > 1) return Kept::none;
        if (at + reach > 1) found = Kept::some;
    }
    return found;
}

Kept before(const ClipPlane& plane, const octree::Cube& cube) {
    const dvec3 normal = kept_side(plane);
    const double half = cube.size / 2;
    const double at = glm::dot(normal, cube.min + half - plane.position);
    const double reach = half * glm::dot(glm::abs(normal), dvec3(1.0)) * (1 + 1e-5);
    return at > reach ? Kept::all : at < -reach ? Kept::none : Kept::some;
}

bool in_box(const ClipBox& box, const dvec3& point) {
    const BoxFrame frame = frame_of(box);
    return std::ranges::all_of(frame.axes, [&](const dvec3& axis) {
        constexpr double kRounding = 1e-14;
        return std::abs(glm::dot(axis, point - frame.centre)) <= 1 + kRounding;
    });
}

}  // namespace

bool keeps(const Clip& clip, const dvec3& point) {
    bool any = false, inside = false;
    for (const ClipBox& box : clip.boxes) {
        const bool in = in_box(box, point);
        if (box.inverted && in) return false;
        if (box.inverted) continue;
        any = true;
        inside |= in;
    }
    return (inside || !any) && std::ranges::all_of(clip.planes, [&](const ClipPlane& plane) {
               return glm::dot(kept_side(plane), point - plane.position) >= 0;
           });
}

DeviceClip device_clip(const Clip& clip, const dvec3& local_origin, double metres_per_unit) {
    DeviceClip device;
    const auto row = [&](const dvec3& axis, const dvec3& centre) {
        return glm::vec4(glm::vec3(axis / metres_per_unit),
                         static_cast<float>(glm::dot(axis, local_origin - centre)));
    };
    for (const ClipBox& box : clip.boxes) {
        const BoxFrame frame = frame_of(box);
        ClipShape shape{};
        for (size_t i = 0; i < 3; ++i) shape.axis[i] = row(frame.axes[i], frame.centre);
        shape.kind.x = box.inverted ? kClipOutside : kClipInside;
        device.shapes.push_back(shape);
    }
    for (const ClipPlane& plane : clip.planes) {
        ClipShape shape{};
        shape.axis[0] = row(kept_side(plane), plane.position);
        shape.kind.x = kClipPlane;
        device.shapes.push_back(shape);
    }
    if (!device.shapes.empty()) device.shapes[0].kind.y = static_cast<float>(device.shapes.size());
    return device;
}

bool DeviceClip::keeps(const glm::vec3& p) const {
    uint32_t known = kClipUntold;
    for (const ClipShape& s : shapes) known = clip_fold(known, p, s.axis[0], s.axis[1], s.axis[2], s.kind.x);
    return clip_kept(known);
}

Kept kept(const Clip& clip, const octree::Cube& cube) {
    Kept whole = Kept::all;
    bool any_inside = false;
    Kept best = Kept::none;  // over the boxes that keep what is inside
    for (const ClipBox& box : clip.boxes) {
        const Kept in = inside(box, cube);
        if (box.inverted) {
            if (in == Kept::all) return Kept::none;
            if (in == Kept::some) whole = Kept::some;
        } else {
            any_inside = true;
            best = std::max(best, in);
        }
    }
    if (any_inside) whole = std::min(whole, best);
    for (const ClipPlane& plane : clip.planes) whole = std::min(whole, before(plane, cube));
    return whole;
}

}  // namespace lucarne::gi
