#pragma once

#include <algorithm>
#include <cmath>

#include <glm/common.hpp>
#include <glm/geometric.hpp>
#include <glm/vec3.hpp>

namespace lucarne::gi {

/// How far a disc reaches from its centre along the axes of the coordinates, m.
struct DiscBounds {
    glm::vec3 low, high;
};

/// Returns the bounds of a disc with a unit normal that ends at a line (gi/shared/edge.h; zero: none). Along
/// an axis it reaches to its farthest point, or where the line cuts that off, to the nearer end of the chord.
inline DiscBounds disc_bounds(const glm::vec3& normal, float radius, const glm::vec3& edge) {
    const glm::vec3 share = glm::sqrt(glm::max(glm::vec3(0.0f), 1.0f - normal * normal));
    DiscBounds bounds{-radius * share, radius * share};
    const float size = glm::length(edge);
    if (!(size * radius > 1)) return bounds;
    const glm::vec3 toward = edge / size;
    const float half_chord = std::sqrt(radius * radius - 1 / (size * size));
    const glm::vec3 across = half_chord * glm::abs(glm::cross(normal, toward));
    for (int axis = 0; axis < 3; ++axis) {
        const float foot = toward[axis] / size;
        if (radius * edge[axis] > share[axis]) bounds.high[axis] = foot + across[axis];
        if (-radius * edge[axis] > share[axis]) bounds.low[axis] = foot - across[axis];
    }
    return bounds;
}

}  // namespace lucarne::gi
