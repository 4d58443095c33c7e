#include "viewer/navigation.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <numbers>

#include <glm/geometric.hpp>

namespace lucarne::viewer {
namespace {

constexpr double kTurn = std::numbers::pi;  ///< radians for a drag over the window's height
constexpr double kZoom = 0.85;              ///< of the distance, a notch
constexpr double kFaster = 1.25;            ///< flying speed, a notch
constexpr double kFast = 4;                 ///< with Shift
constexpr double kLongestStep = 0.25;       ///< s: a slow frame does not throw the camera out of the house

constexpr std::array kNames = {"orbit", "fly"};

}  // namespace

const char* navigation_name(NavigationMode mode) {
    return kNames[static_cast<size_t>(mode)];
}
std::optional<NavigationMode> navigation_mode(std::string_view name) {
    for (size_t i = 0; i < kNames.size(); ++i)
        if (name == kNames[i]) return static_cast<NavigationMode>(i);
    return std::nullopt;
}

bool Navigation::apply(const NavigationInput& input, CameraRig& rig) {
    bool moved = false;
    const bool dragged = input.drag != glm::dvec2(0.0);
    if (dragged && input.rotate) {
        const double yaw = -input.drag.x * kTurn, pitch = -input.drag.y * kTurn;
        if (mode_ == NavigationMode::orbit) {
            rig.orbit(yaw, pitch);
        } else {
            rig.look(yaw, pitch);
        }
        moved = true;
    } else if (dragged && input.shift) {
        rig.pan({input.drag.x, -input.drag.y});
        moved = true;
    }
    if (input.scroll != 0 && mode_ == NavigationMode::orbit) {
        rig.zoom(std::pow(kZoom, std::clamp(input.scroll, -20.0, 20.0)), rig.pivot());
        moved = true;
    } else if (input.scroll != 0) {
        speed_ = std::clamp(speed_ * std::pow(kFaster, input.scroll), 1e-6, 1e9);
    }
    if (mode_ == NavigationMode::fly && input.keys != glm::dvec3(0.0)) {
        const double distance = speed_ * std::min(input.seconds, kLongestStep) * (input.fast ? kFast : 1);
        rig.fly(glm::normalize(input.keys) * distance);
        moved = true;
    }
    return moved;
}

}  // namespace lucarne::viewer
