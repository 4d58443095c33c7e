#pragma once

#include <optional>
#include <string_view>

#include <glm/vec2.hpp>
#include <glm/vec3.hpp>

#include "viewer/camera/camera.h"

namespace lucarne::viewer {

enum class NavigationMode {
    orbit,      ///< turns around the point under the cursor
    turntable,  ///< turns around the pivot, which a double-click chooses
    fly,
    walk  ///< stays at eye height above the floor
};
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

/// Turns input into camera moves. Orbit and turntable: drags turn and pan about the pivot, scrolling goes to
/// it. Fly and walk: drags look around, keys move, scrolling sets the speed.
class Navigation {
 public:
    /// `scene_size`: the scene's diagonal, world units; sets the first flying speed.
    explicit Navigation(double scene_size) { set_scene(scene_size, 1); }
    void set_scene(double scene_size, double metres_per_unit);

    NavigationMode mode() const { return mode_; }
    void set_mode(NavigationMode mode) { mode_ = mode; }
    /// Whether drags turn the scene rather than the head.
    bool turns_scene() const { return mode_ == NavigationMode::orbit || mode_ == NavigationMode::turntable; }
    double speed() const {
        return mode_ == NavigationMode::walk ? walking_speed_ : speed_;
    }  ///< world units a second
    bool gravity() const { return gravity_; }
    void set_gravity(bool gravity) { gravity_ = gravity; }
    double eye_height() const { return eye_height_; }  ///< world units
    /// The floor under the camera, world z, if one is known; who walks with gravity is brought to eye height
    /// above it.
    void set_floor(std::optional<double> floor) { floor_ = floor; }
    /// True where the camera moved.
    bool apply(const NavigationInput& input, CameraRig& rig);

 private:
    bool settle(double seconds, CameraRig& rig) const;

    NavigationMode mode_ = NavigationMode::orbit;
    double speed_ = 1, walking_speed_ = 1, eye_height_ = 1;
    bool gravity_ = true;
    std::optional<double> floor_;
};

}  // namespace lucarne::viewer
