#include "io/formats/crs/frame.h"

#include <algorithm>
#include <cmath>

#include <fmt/format.h>
#include <glm/geometric.hpp>
#include <glm/trigonometric.hpp>

#include "io/core/log.h"

namespace lucarne::io {
namespace {

glm::dvec3 centre(const StatedBox& box) {
    return box->front() / 2.0 + box->back() / 2.0;
}

bool on_globe(const glm::dvec3& at) {
    return std::abs(at.x) <= 180 && std::abs(at.y) <= 90;
}

/// Returns the UTM zone of a place in degrees: "UTM zone 33N, EPSG:32633".
std::string utm_zone(double longitude, double latitude) {
    const int zone = std::clamp(static_cast<int>(std::floor((longitude + 180) / 6)) + 1, 1, 60);
    const bool north = latitude >= 0;
    return fmt::format("UTM zone {}{}, EPSG:{}", zone, north ? 'N' : 'S', (north ? 32600 : 32700) + zone);
}

}  // namespace

bool from_earth_centre(const StatedBox& box) {
    constexpr double kNearest = 6.3e6, kFarthest = 6.5e6, kAboveMountains = 2e4;  // metres
    if (!box) return false;
    const double distance = glm::length(centre(box));
    return distance >= kNearest && distance <= kFarthest && std::abs(centre(box).z) > kAboveMountains;
}

bool like_degrees(const StatedBox& box, const glm::dvec3& scale) {
    const double fine = std::max(std::abs(scale.x), std::abs(scale.y));
    return box && on_globe(box->front()) && on_globe(box->back()) && fine <= 1e-6 &&
           std::abs(scale.z) >= 100 * fine;
}

void warn_of_degrees(const std::string& file, const StatedBox& box, bool sure) {
    const bool known = box && on_globe(centre(box));
    log::warn("{}: its coordinates {} degrees, not lengths; convert them to a projected coordinate system{}",
              file, sure ? "are" : "seem to be",
              known ? " (" + utm_zone(centre(box).x, centre(box).y) + ")" : "");
}

void warn_of_earth_centre(const std::string& file, const StatedBox& box) {
    if (!from_earth_centre(box)) return;
    const glm::dvec3 at = centre(box);
    log::warn(
        "{}: its coordinates begin at the centre of the earth, so z is not up; convert them to a projected "
        "coordinate system ({})",
        file,
        utm_zone(glm::degrees(std::atan2(at.y, at.x)),
                 glm::degrees(std::atan2(at.z, std::hypot(at.x, at.y)))));
}

}  // namespace lucarne::io
