#pragma once

#include <array>
#include <cmath>
#include <cstddef>

#include <glm/common.hpp>
#include <glm/geometric.hpp>
#include <glm/vec3.hpp>

#include "gi/volume/grid.h"

namespace lucarne::gi::volume {

/// Voxels count as touched by what is nearer than this share of their side, so that walls which lie in the
/// border of two voxels are closed whatever their positions are rounded to.
inline constexpr float kTouching = 1e-3f;

/// A convex polygon in a plane, in units of voxels.
struct Polygon {
    static constexpr size_t kMost = 16;  ///< an octagon that six planes have cut has at most 14 corners
    std::array<glm::vec3, kMost> corners;
    size_t count = 0;

    void add(const glm::vec3& corner) { corners[count++] = corner; }
    float area() const {
        glm::vec3 sum(0.0f);
        for (size_t i = 2; i < count; ++i)
            sum += glm::cross(corners[i - 1] - corners[0], corners[i] - corners[0]);
        return 0.5f * glm::length(sum);
    }
};

/// Returns the octagon about a disc, in units of the grid's voxels.
Polygon octagon_about(const Grid& grid, const glm::vec3& position, const glm::vec3& normal, float radius);

/// Returns the part of a polygon in which a coordinate is at least `low` (or with `sign` -1, at most -`low`).
Polygon cut(const Polygon& polygon, int axis, float sign, float low);

namespace details {

inline void range_along(const Polygon& polygon, int axis, int most, int& first, int& last) {
    float low = polygon.corners[0][axis], high = low;
    for (size_t i = 1; i < polygon.count; ++i) {
        low = std::min(low, polygon.corners[i][axis]);
        high = std::max(high, polygon.corners[i][axis]);
    }
    // Comparisons as floats: a hostile polygon may lie beyond the range of int.
    const auto end = static_cast<float>(most);
    first = static_cast<int>(std::clamp(std::floor(low - kTouching), 0.0f, end));
    last = static_cast<int>(std::clamp(std::floor(high + kTouching), -1.0f, end - 1));
}

template <class Body>
void for_each_voxel(const Grid& grid, const Polygon& polygon, int axis, glm::ivec3 cell, const Body& body) {
    if (polygon.count < 3) return;
    if (axis == 3) {
        body(cell, polygon.area());
        return;
    }
    int first = 0, last = 0;
    range_along(polygon, axis, grid.size[axis], first, last);
    for (int i = first; i <= last; ++i) {
        cell[axis] = i;
        if (first == last)
            for_each_voxel(grid, polygon, axis + 1, cell, body);
        else
            for_each_voxel(grid,
                           cut(cut(polygon, axis, 1, static_cast<float>(i) - kTouching), axis, -1,
                               -static_cast<float>(i + 1) - kTouching),
                           axis + 1, cell, body);
    }
}

}  // namespace details

/// Calls body(cell, area) for every voxel of the grid that a disc touches (an octagon about the disc, which
/// touches a few more), with the area of the octagon inside it, in units of a voxel's face.
template <class Body>
void for_each_voxel(const Grid& grid, const glm::vec3& position, const glm::vec3& normal, float radius,
                    const Body& body) {
    details::for_each_voxel(grid, octagon_about(grid, position, normal, radius), 0, glm::ivec3(0), body);
}

}  // namespace lucarne::gi::volume
