#include "viewer/style/clip_handles.h"

#include <algorithm>
#include <cmath>
#include <numbers>

#include <glm/geometric.hpp>

namespace lucarne::viewer {
namespace {

using glm::dvec3;

/// Returns a unit vector.
dvec3 box_axis(const gi::ClipBox& box, int axis) {
    const double c = std::cos(box.rotation), s = std::sin(box.rotation);
    return axis == 0 ? dvec3(c, s, 0) : axis == 1 ? dvec3(-s, c, 0) : dvec3(0, 0, 1);
}

}  // namespace

std::vector<ClipHandle> clip_handles(const gi::Clip& clip) {
    std::vector<ClipHandle> handles;
    for (size_t i = 0; i < clip.boxes.size(); ++i)
        for (int face = 0; face <= ClipHandle::kCorner; ++face) handles.push_back({false, i, face});
    for (size_t i = 0; i < clip.planes.size(); ++i) handles.push_back({true, i, 0});
    return handles;
}

HandlePlace handle_place(const gi::Clip& clip, const ClipHandle& handle) {
    if (handle.plane) {
        const gi::ClipPlane& plane = clip.planes[handle.index];
        return {plane.position, glm::normalize(plane.normal)};
    }
    const gi::ClipBox& box = clip.boxes[handle.index];
    const dvec3 half = (box.max - box.min) / 2.0;
    if (handle.face == ClipHandle::kCorner) return {box_corners(box)[7], {0, 0, 1}};
    const int axis = handle.face / 2;
    const dvec3 outward = box_axis(box, axis) * (handle.face % 2 ? 1.0 : -1.0);
    return {(box.min + box.max) / 2.0 + outward * half[axis], outward};
}

void move_handle(gi::Clip& clip, const ClipHandle& handle, double by) {
    const dvec3 outward = handle_place(clip, handle).axis;
    if (handle.plane) {
        clip.planes[handle.index].position += outward * by;
        return;
    }
    gi::ClipBox& box = clip.boxes[handle.index];
    const int axis = handle.face / 2;
    dvec3 centre = (box.min + box.max) / 2.0, half = (box.max - box.min) / 2.0;
    const double least = half[axis] / 1000;
    const double moved = std::max(half[axis] + by / 2, least);
    centre += outward * (moved - half[axis]);
    half[axis] = moved;
    box.min = centre - half;
    box.max = centre + half;
}

std::array<dvec3, 8> box_corners(const gi::ClipBox& box) {
    const dvec3 centre = (box.min + box.max) / 2.0, half = (box.max - box.min) / 2.0;
    std::array<dvec3, 8> corners;
    for (int i = 0; i < 8; ++i) {
        dvec3 corner = centre;
        for (int axis = 0; axis < 3; ++axis)
            corner += box_axis(box, axis) * half[axis] * (i >> axis & 1 ? 1.0 : -1.0);
        corners[static_cast<size_t>(i)] = corner;
    }
    return corners;
}

std::optional<double> turned_to(const gi::ClipBox& box, const dvec3& eye, const dvec3& ray) {
    const dvec3 centre = (box.min + box.max) / 2.0, corner = box_corners(box)[7] - centre;
    if (!(std::abs(ray.z) > 1e-3 * glm::length(ray)))
        return std::nullopt;  // the ray is parallel to the plane
    const double along = (centre.z + corner.z - eye.z) / ray.z;
    const dvec3 place = eye + ray * along - centre;
    if (!(along > 0) || !(place.x * place.x + place.y * place.y > 0)) return std::nullopt;
    const double turn = std::atan2(place.y, place.x) - std::atan2(corner.y, corner.x);
    return std::remainder(box.rotation + turn, 2 * std::numbers::pi);
}

std::optional<double> along_axis(const dvec3& origin, const dvec3& axis, const dvec3& eye, const dvec3& ray) {
    // The axis's end of the shortest segment between two lines.
    const dvec3 direction = glm::normalize(ray), between = origin - eye;
    const double cosine = glm::dot(axis, direction), sine2 = 1 - cosine * cosine;
    if (!(sine2 > 1e-4)) return std::nullopt;
    return (cosine * glm::dot(direction, between) - glm::dot(axis, between)) / sine2;
}

}  // namespace lucarne::viewer
