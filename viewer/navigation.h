#pragma once

#include <optional>
#include <string_view>

#include <glm/vec2.hpp>
#include <glm/vec3.hpp>

#include "viewer/camera.h"

namespace lucarne::viewer {

enum class NavigationMode { orbit, fly };
/// "orbit", as settings have it.
const char* navigation_name(NavigationMode mode);
std::optional<NavigationMode> navigation_mode(std::string_view name);

/// What pointer and keys did since the last frame, where no panel took it.
struct NavigationInput {
    glm::dvec2 drag{0.0};                ///< shares of the window's height, right and down
    double scroll = 0;                   ///< notches; up is positive
    bool rotate = false, shift = false;  ///< which drag it is: turning, or moving sideways
    glm::dvec3 keys{0.0};                ///< right, up, forward: -1, 0 or 1 each
    bool fast = false;                   ///< with Shift
    double seconds = 0;                  ///< since the last frame
};

/// Turns input into camera moves. Orbit: drags turn and pan about the pivot, scrolling goes to the pivot.
/// Fly: drags look around, keys move, scrolling sets the speed.
class Navigation {
 public:
    /// `scene_size`: the scene's diagonal, world units; sets the first flying speed.
    explicit Navigation(double scene_size) : speed_(scene_size / 20) {}

    void set_scene_size(double scene_size) { speed_ = scene_size / 20; }
    NavigationMode mode() const { return mode_; }
    void set_mode(NavigationMode mode) { mode_ = mode; }
    double speed() const { return speed_; }  ///< world units a second
    /// True where the camera moved.
    bool apply(const NavigationInput& input, CameraRig& rig);

 private:
    NavigationMode mode_ = NavigationMode::orbit;
    double speed_;
};

}  // namespace lucarne::viewer
