#pragma once

#include <algorithm>
#include <array>
#include <cassert>
#include <cmath>
#include <cstddef>

#include <glm/geometric.hpp>
#include <glm/vec3.hpp>

namespace lucarne::gi::volume {

/// A convex polygon in a plane, in units of voxels.
template <class T>
struct BasicPolygon {
    using Point = glm::vec<3, T>;
    static constexpr size_t kMost = 16;  ///< an octagon that six planes have cut has at most 14 corners
    std::array<Point, kMost> corners;
    size_t count = 0;

    void add(const Point& corner) { corners[count++] = corner; }
    T area() const {
        Point sum(0);
        for (size_t i = 2; i < count; ++i)
            sum += glm::cross(corners[i - 1] - corners[0], corners[i] - corners[0]);
        return glm::length(sum) / 2;
    }
};
using Polygon = BasicPolygon<float>;

/// Returns the part of a polygon in which a coordinate is at least `low` (or with `sign` -1, at most -`low`).
template <class T>
BasicPolygon<T> cut(const BasicPolygon<T>& polygon, int axis, T sign, T low) {
    // Sutherland & Hodgman 1974, "Reentrant polygon clipping", for one plane.
    BasicPolygon<T> kept;
    if (polygon.count == 0) return kept;
    const auto* from = &polygon.corners[0];
    T before = sign * (*from)[axis] - low;
    for (size_t i = 0; i < polygon.count; ++i) {
        const auto& to = polygon.corners[i + 1 < polygon.count ? i + 1 : 0];
        const T after = sign * to[axis] - low;
        if (before >= 0) kept.add(*from);
        if ((before >= 0) != (after >= 0)) kept.add(*from + (to - *from) * (before / (before - after)));
        assert(kept.count < BasicPolygon<T>::kMost);
        from = &to, before = after;
    }
    return kept;
}

/// How far a polygon reaches along an axis, and the layers that it touches there.
template <class T>
struct Layers {
    T low, high;
    int first, last;  ///< none: the last is below the first
};

/// Returns which of `most` layers along an axis are touched by what reaches from `low` to `high`, or is
/// nearer than `touching`, in voxels.
template <class T>
Layers<T> layers_between(T low, T high, int most, T touching) {
    // Comparisons as floats: a hostile polygon may lie beyond the range of int. Below zero truncation is no
    // rounding down, but nothing lies there.
    const auto end = static_cast<T>(most);
    const T last = high + touching;
    return {low, high, static_cast<int>(std::clamp(low - touching, T(0), end)),
            last < 0 || most == 0 ? -1 : static_cast<int>(std::min(last, end - T(0.5)))};
}

/// Returns which of `most` layers along an axis a polygon touches.
template <class T>
Layers<T> layers_of(const BasicPolygon<T>& polygon, int axis, int most, T touching) {
    T low = polygon.corners[0][axis], high = low;
    for (size_t i = 1; i < polygon.count; ++i) {
        low = std::min(low, polygon.corners[i][axis]);
        high = std::max(high, polygon.corners[i][axis]);
    }
    return layers_between(low, high, most, touching);
}

/// Calls body(cell, part) for every voxel of a grid of this size that a polygon touches, with the part of the
/// polygon inside it. Voxels reach `touching` beyond their sides; if that is zero, what lies in the border of
/// two belongs to the upper one, and the parts add up to the polygon.
template <class T, class Body>
void for_each_voxel_of(const glm::ivec3& size, const BasicPolygon<T>& polygon, T touching, const Body& body,
                       int axis = 0, glm::ivec3 cell = glm::ivec3(0)) {
    if (polygon.count < 3) return;
    if (axis == 3) {
        body(cell, polygon);
        return;
    }
    const Layers<T> layers = layers_of(polygon, axis, size[axis], touching);
    for (int i = layers.first; i <= layers.last; ++i) {
        cell[axis] = i;
        const T low = static_cast<T>(i) - touching, high = static_cast<T>(i + 1) + touching;
        const bool below = layers.low<low, above = layers.high> high;
        if (!below && !above)
            for_each_voxel_of(size, polygon, touching, body, axis + 1, cell);
        else if (!above)
            for_each_voxel_of(size, cut(polygon, axis, T(1), low), touching, body, axis + 1, cell);
        else if (!below)
            for_each_voxel_of(size, cut(polygon, axis, T(-1), -high), touching, body, axis + 1, cell);
        else
            for_each_voxel_of(size, cut(cut(polygon, axis, T(1), low), axis, T(-1), -high), touching, body,
                              axis + 1, cell);
    }
}

}  // namespace lucarne::gi::volume
