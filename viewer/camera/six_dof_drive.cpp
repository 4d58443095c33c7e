#include "viewer/camera/six_dof_drive.h"

#include <algorithm>
#include <cmath>
#include <numbers>

#include <glm/geometric.hpp>

namespace lucarne::viewer {
namespace {

constexpr double kTurnRate = std::numbers::pi / 2;  ///< radians a second
constexpr double kPan = 1;                          ///< shift at full travel, picture heights a second
constexpr double kZoomRate = 2;                     ///< zoom at full travel, factor of the distance a second
constexpr double kLongestReport = 0.25;             ///< s: limit, so that a slow frame makes no huge step

}  // namespace

bool drive(const io::SixDofState& cap, SixDofHold hold, double speed, double seconds, CameraRig& rig) {
    const double step = std::clamp(seconds, 0.0, kLongestReport);
    const glm::dvec3 push = cap.push * step;
    const double pitch = cap.turn.x * kTurnRate * step, yaw = cap.turn.y * kTurnRate * step;
    if (push == glm::dvec3(0.0) && pitch == 0 && yaw == 0) return false;
    if (hold == SixDofHold::camera) {
        rig.look(yaw, pitch);
        rig.fly(push * speed);
    } else {
        rig.orbit(-yaw, -pitch);
        rig.pan(glm::dvec2(push.x, push.y) * kPan);
        rig.zoom(std::pow(kZoomRate, push.z), rig.pivot());
    }
    return true;
}

}  // namespace lucarne::viewer
