#include "viewer/camera/navigation.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <numbers>

#include <glm/geometric.hpp>

namespace lucarne::viewer {
namespace {

constexpr double kTurn = std::numbers::pi;  ///< radians turned by a drag over the window's height
constexpr double kZoom = 0.85;              ///< factor of the distance for one notch of scrolling
constexpr double kFaster = 1.25;            ///< factor of the flying speed for one notch
constexpr double kFast = 4;                 ///< factor of the speed while Shift is held
constexpr double kWalking = 2.0;            ///< m/s
constexpr double kEyeHeight = 1.65;         ///< m
constexpr double kSettling = 8.0;           ///< 1/s: rate at which the camera approaches eye height
constexpr double kLongestStep = 0.25;       ///< s: limit, so that a slow frame makes no huge step

constexpr std::array kNames = {"orbit", "turntable", "fly", "walk"};

}  // namespace

const char* navigation_name(NavigationMode mode) {
    return kNames[static_cast<size_t>(mode)];
}
std::optional<NavigationMode> navigation_mode(std::string_view name) {
    for (size_t i = 0; i < kNames.size(); ++i)
        if (name == kNames[i]) return static_cast<NavigationMode>(i);
    return std::nullopt;
}

void Navigation::set_scene(double scene_size, double metres_per_unit) {
    speed_ = scene_size / 20;
    walking_speed_ = kWalking / metres_per_unit;
    eye_height_ = kEyeHeight / metres_per_unit;
}

/// Brings the camera to eye height gradually, so that stairs do not make it jump.
bool Navigation::settle(double seconds, CameraRig& rig) const {
    if (mode_ != NavigationMode::walk || !gravity_ || !floor_) return false;
    const double lacking = *floor_ + eye_height_ - rig.position().z;
    if (std::abs(lacking) < eye_height_ * 1e-3) return false;
    rig.fly({0, lacking * std::min(1.0, kSettling * std::min(seconds, kLongestStep)), 0});
    return true;
}

bool Navigation::apply(const NavigationInput& input, CameraRig& rig) {
    bool moved = false;
    const bool dragged = input.drag != glm::dvec2(0.0);
    if (dragged && input.rotate) {
        const double yaw = -input.drag.x * kTurn, pitch = -input.drag.y * kTurn;
        if (turns_scene() && !(mode_ == NavigationMode::orbit && input.inside)) {
            rig.orbit(yaw, pitch);
        } else {
            rig.look(yaw, pitch);
        }
        moved = true;
    } else if (dragged && input.shift) {
        rig.pan({input.drag.x, -input.drag.y});
        moved = true;
    }
    if (input.scroll != 0 && turns_scene()) {
        rig.zoom(std::pow(kZoom, std::clamp(input.scroll, -20.0, 20.0)), rig.pivot());
        moved = true;
    } else if (input.scroll != 0) {
        double& speed = mode_ == NavigationMode::walk ? walking_speed_ : speed_;
        speed = std::clamp(speed * std::pow(kFaster, input.scroll), 1e-6, 1e9);
    }
    if (!turns_scene() && input.keys != glm::dvec3(0.0)) {
        const double distance = speed() * std::min(input.seconds, kLongestStep) * (input.fast ? kFast : 1);
        const glm::dvec3 step = glm::normalize(input.keys) * distance;
        if (mode_ == NavigationMode::fly) {
            rig.fly(step);
        } else {
            rig.walk(step);
            if (!gravity_) rig.fly({0, step.y, 0});
        }
        moved = true;
    }
    if (settle(input.seconds, rig)) moved = true;
    return moved;
}

}  // namespace lucarne::viewer
