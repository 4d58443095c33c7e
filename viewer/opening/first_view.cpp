#include "viewer/opening/first_view.h"

#include <algorithm>
#include <cassert>
#include <cmath>

#include <glm/geometric.hpp>
#include <glm/trigonometric.hpp>
#include <glm/vector_relational.hpp>

namespace lucarne::viewer {
namespace {

constexpr double kOutsideFov = glm::radians(50.0);
constexpr double kInsideFov = glm::radians(62.0);
constexpr double kTerrainPitch = glm::radians(35.0);
/// Largest pitch of the view along a room, toward the middle of its height.
constexpr double kMostPitch = glm::radians(8.0);

/// The part of the extent that two points have to be apart to count as two.
constexpr double kLeastSpan = 1e-6;

ViewAxes axes_along(const glm::dvec3& forward) {
    const glm::dvec3 right = normalize(cross(forward, glm::dvec3(0, 0, 1)));
    return {right, cross(right, forward), forward};
}

}  // namespace

gi::SceneCamera outside_view(const Site& site, const PictureShape& shape) {
    const glm::dvec3 forward = site.kind == SiteKind::terrain
                                   ? glm::dvec3(0, std::cos(kTerrainPitch), -std::sin(kTerrainPitch))
                                   : normalize(glm::dvec3(.55, 1, -.6));
    const double size = std::max(glm::distance(site.box[0], site.box[1]), 2e-3);
    gi::SceneCamera camera;
    camera.name = "overview";
    camera.vertical_fov = kOutsideFov;
    camera.position =
        fitting_position(site.outline, axes_along(forward), kOutsideFov, shape, kLeastSpan * size);
    const double distance =
        std::max(dot((site.box[0] + site.box[1]) / 2.0 - camera.position, forward), kLeastSpan * size);
    camera.target = camera.position + forward * distance;
    return camera;
}

gi::SceneCamera inside_view(const Site& site, const PictureShape& shape) {
    assert(site.inside);
    const StandingPlace& place = *site.inside;
    const double rise = (place.floor + place.ceiling) / 2 - place.eye.z;
    const double pitch = std::clamp(std::atan2(rise, place.free_ahead / 2), -kMostPitch, kMostPitch);
    // Turn so that what lies ahead is in the middle of the free part.
    const double half = std::tan(kInsideFov / 2);
    const double turn = std::atan((shape.free.left + shape.free.right) / 2 * half * shape.aspect);
    const double yaw = std::atan2(place.ahead.y, place.ahead.x) + turn;
    gi::SceneCamera camera;
    camera.name = "inside";
    camera.vertical_fov = kInsideFov;
    camera.position = place.eye;
    camera.target = place.eye + glm::dvec3(std::cos(yaw) * std::cos(pitch), std::sin(yaw) * std::cos(pitch),
                                           std::sin(pitch)) *
                                    (place.free_ahead / 2);
    return camera;
}

gi::SceneCamera first_view(const Site& site, const PictureShape& shape) {
    const bool inside = site.kind == SiteKind::interior && site.inside;
    return inside ? inside_view(site, shape) : outside_view(site, shape);
}

bool looks_in_from_outside(const Site& site, const gi::SceneCamera& camera) {
    if (site.kind != SiteKind::interior) return false;
    return camera.orthographic_height > 0 || glm::any(glm::lessThan(camera.position, site.box[0])) ||
           glm::any(glm::greaterThan(camera.position, site.box[1]));
}

}  // namespace lucarne::viewer
