#include "octree/stream/motion.h"

#include <algorithm>
#include <cmath>

#include <glm/geometric.hpp>

namespace lucarne::octree {
namespace {

constexpr double kFarthestTurn = 1.0;  ///< radians; directions further ahead cannot be predicted

/// Rotates `v` about the unit vector `axis` (Rodrigues 1840).
glm::dvec3 rotated(const glm::dvec3& v, const glm::dvec3& axis, double angle) {
    return v * std::cos(angle) + glm::cross(axis, v) * std::sin(angle) +
           axis * (glm::dot(axis, v) * (1 - std::cos(angle)));
}

/// The rotation between two views' axes, as axis times angle. It is exact for a rotation about a common axis
/// and good for the small angles between frames.
glm::dvec3 turn_between(const View& a, const View& b) {
    const glm::dvec3 sum =
        glm::cross(a.forward, b.forward) + glm::cross(a.right, b.right) + glm::cross(a.up, b.up);
    const double sine = glm::length(sum) / 2;  // `sum` is 2 sin(angle) times the rotation's axis
    return sine > 0 ? sum / (2 * sine) * std::asin(std::min(sine, 1.0)) : glm::dvec3(0.0);
}

}  // namespace

void Motion::observe(const View& view) {
    first_ = before_;
    before_ = last_;
    last_ = view;
}

void Motion::forget() {
    first_ = before_ = last_ = std::nullopt;
}

std::optional<View> Motion::ahead(double frames) const {
    if (!before_) return std::nullopt;
    const View& from = first_ ? *first_ : *before_;
    const double steps = frames / (first_ ? 2 : 1);
    const glm::dvec3 way = (last_->position - from.position) * steps,
                     turn = turn_between(from, *last_) * steps;
    const double angle = glm::length(turn);
    if (way == glm::dvec3(0.0) && angle == 0) return std::nullopt;
    View view = *last_;
    view.position += way;
    if (angle > 0) {
        const glm::dvec3 axis = turn / angle;
        for (glm::dvec3* direction : {&view.forward, &view.right, &view.up})
            *direction = glm::normalize(rotated(*direction, axis, std::min(angle, kFarthestTurn)));
    }
    return view;
}

}  // namespace lucarne::octree
