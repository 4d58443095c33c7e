#include "viewer/opening/first_view.h"

#include <algorithm>
#include <array>
#include <cassert>
#include <cmath>
#include <numbers>
#include <vector>

#include <glm/geometric.hpp>
#include <glm/trigonometric.hpp>
#include <glm/vector_relational.hpp>

namespace lucarne::viewer {
namespace {

constexpr double kOutsideFov = glm::radians(50.0);
constexpr double kInsideFov = glm::radians(62.0);
constexpr double kOnGround = 1.7;        ///< height of the eye above the ground, m
constexpr double kCellsOfOutline = 128;  ///< along the longest side, unless the scan has few points
constexpr double kTerrainPitch = glm::radians(35.0);
/// Largest pitch of the view along a room, toward the middle of its height.
constexpr double kMostPitch = glm::radians(8.0);

/// What lies within this angle of the middle direction is on one side of a scanner, up to this share of it.
constexpr double kOneSide = glm::radians(60.0), kBeside = .05;
constexpr int kAzimuths = 36;
/// Directions steeper than this (sine) are those of depth cameras, in whose files z leads ahead and y down,
/// or z back and y up. A view that leans toward y by this much (tangent) has them upright with z as its
/// vertical.
constexpr double kSteep = .75, kLean = .14;

/// The part of the extent that two points have to be apart to count as two.
constexpr double kLeastSpan = 1e-6;

ViewAxes axes_along(const glm::dvec3& forward) {
    const glm::dvec3 right = normalize(cross(forward, glm::dvec3(0, 0, 1)));
    return {right, cross(right, forward), forward};
}

/// Returns the camera that sees all of a site along a direction.
gi::SceneCamera fitting_view(const Site& site, const glm::dvec3& forward, const PictureShape& shape) {
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

/// Returns the horizontal direction from a place around which a picture shows most of a site.
double fullest_azimuth(const Site& site, const glm::dvec3& from, double half_width) {
    std::array<double, kAzimuths> seen{};
    const auto azimuth_of = [](int i) { return 2 * std::numbers::pi * i / kAzimuths; };
    for (const glm::dvec3& point : site.outline) {
        const glm::dvec3 to = point - from;
        for (int i = 0; i < kAzimuths; ++i) {
            const glm::dvec3 ahead(std::cos(azimuth_of(i)), std::sin(azimuth_of(i)), 0);
            const double depth = dot(to, ahead);
            const double aside = std::abs(to.x * ahead.y - to.y * ahead.x);
            seen[i] += aside < half_width * depth && std::abs(to.z) < std::tan(kInsideFov / 2) * depth;
        }
    }
    return azimuth_of(static_cast<int>(std::ranges::max_element(seen) - seen.begin()));
}

}  // namespace

gi::SceneCamera outside_view(const Site& site, const PictureShape& shape) {
    const glm::dvec3 forward = site.kind == SiteKind::terrain
                                   ? glm::dvec3(0, std::cos(kTerrainPitch), -std::sin(kTerrainPitch))
                                   : normalize(glm::dvec3(.55, 1, -.6));
    return fitting_view(site, forward, shape);
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

gi::SceneCamera ground_view(const Site& site, const PictureShape& shape) {
    const glm::dvec3 sides = site.box[1] - site.box[0];
    // The outline has cells of the grid: the ground may lie half of one above its middle.
    const double rise =
        kOnGround / site.metres_per_unit + std::max({sides.x, sides.y, sides.z}) / kCellsOfOutline;
    gi::SceneCamera camera;
    camera.name = "ground";
    camera.vertical_fov = kInsideFov;
    camera.position = *std::ranges::max_element(site.outline, {}, &glm::dvec3::z) + glm::dvec3(0, 0, rise);
    const double azimuth = fullest_azimuth(site, camera.position, std::tan(kInsideFov / 2) * shape.aspect);
    const double distance = std::max(glm::distance(site.box[0], site.box[1]) / 4, kLeastSpan);
    camera.target =
        camera.position + distance * glm::dvec3(std::cos(azimuth), std::sin(azimuth), -std::tan(kMostPitch));
    return camera;
}

gi::SceneCamera station_view(const Site& site, const PictureShape& shape) {
    assert(site.station);
    std::vector<glm::dvec3> directions;
    glm::dvec3 sum(0);
    for (const glm::dvec3& point : site.outline)
        if (const double distance = glm::distance(point, *site.station); distance > 0)
            sum += directions.emplace_back((point - *site.station) / distance);
    if (const double length = glm::length(sum); length > 0) {
        glm::dvec3 middle = sum / length;
        const auto beside = std::ranges::count_if(
            directions, [&](const glm::dvec3& d) { return dot(d, middle) < std::cos(kOneSide); });
        if (std::abs(middle.z) > kSteep) middle = normalize(glm::dvec3(0, kLean, std::copysign(1, middle.z)));
        if (static_cast<double>(beside) <= kBeside * static_cast<double>(directions.size()))
            return fitting_view(site, middle, shape);
    }
    const double azimuth = fullest_azimuth(site, *site.station, std::tan(kInsideFov / 2) * shape.aspect);
    gi::SceneCamera camera;
    camera.name = "station";
    camera.vertical_fov = kInsideFov;
    camera.position = *site.station;
    const double distance = std::max(glm::distance(site.box[0], site.box[1]) / 4, kLeastSpan);
    camera.target = camera.position + glm::dvec3(std::cos(azimuth), std::sin(azimuth), 0) * distance;
    return camera;
}

gi::SceneCamera first_view(const Site& site, const PictureShape& shape) {
    if (site.kind == SiteKind::interior && site.inside) return inside_view(site, shape);
    return site.station ? station_view(site, shape) : outside_view(site, shape);
}

bool looks_in_from_outside(const Site& site, const gi::SceneCamera& camera) {
    if (site.kind != SiteKind::interior) return false;
    return camera.orthographic_height > 0 || glm::any(glm::lessThan(camera.position, site.box[0])) ||
           glm::any(glm::greaterThan(camera.position, site.box[1]));
}

}  // namespace lucarne::viewer
