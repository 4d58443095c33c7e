#include "viewer/camera/glide.h"

#include <algorithm>
#include <cmath>

#include <glm/common.hpp>
#include <glm/geometric.hpp>

namespace lucarne::viewer {
namespace {

/// The direction of a view in angles, so that the horizon stays level on the way.
struct Direction {
    double yaw, pitch, distance;
};
Direction direction_of(const gi::SceneCamera& camera) {
    const glm::dvec3 ahead = camera.target - camera.position;
    return {std::atan2(ahead.y, ahead.x), std::atan2(ahead.z, std::hypot(ahead.x, ahead.y)),
            glm::length(ahead)};
}

}  // namespace

gi::SceneCamera gone_toward(const gi::SceneCamera& camera, const glm::dvec3& point, double distance) {
    glm::dvec3 way = point - camera.position;
    way.z = 0;
    const double length = glm::length(way);
    if (!(length > 0)) return camera;
    way *= (length - std::min(distance, length / 2)) / length;
    gi::SceneCamera gone = camera;
    gone.position += way;
    gone.target += way;
    return gone;
}

void CameraGlide::start(const gi::SceneCamera& from, const gi::SceneCamera& to) {
    from_ = from;
    to_ = to;
    time_ = from.orthographic_height > 0 || to.orthographic_height > 0 ? kSeconds : 0;
    under_way_ = true;
}

std::optional<gi::SceneCamera> CameraGlide::advance(double seconds) {
    if (!under_way_) return std::nullopt;
    time_ += seconds;
    if (time_ >= kSeconds) {
        under_way_ = false;
        return to_;
    }
    const double t = time_ / kSeconds, share = t * t * (3 - 2 * t);
    const Direction a = direction_of(from_), b = direction_of(to_);
    const double yaw = a.yaw + share * std::remainder(b.yaw - a.yaw, 2 * M_PI);
    const double pitch = glm::mix(a.pitch, b.pitch, share);
    gi::SceneCamera camera = to_;
    camera.position = glm::mix(from_.position, to_.position, share);
    camera.target = camera.position + glm::dvec3(std::cos(yaw) * std::cos(pitch),
                                                 std::sin(yaw) * std::cos(pitch), std::sin(pitch)) *
                                          glm::mix(a.distance, b.distance, share);
    camera.vertical_fov = glm::mix(from_.vertical_fov, to_.vertical_fov, share);
    return camera;
}

}  // namespace lucarne::viewer
