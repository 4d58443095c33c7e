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
/// Returns the mode's name as the settings file has it, for example "orbit".
const char* navigation_name(NavigationMode mode);
std::optional<NavigationMode> navigation_mode(std::string_view name);

/// Pointer and key input since the last frame that no panel used.
struct NavigationInput {
    glm::dvec2 drag{0.0};                ///< shares of the window's height, right and down
    double scroll = 0;                   ///< notches; up is positive
    bool rotate = false, shift = false;  ///< kind of the drag: turn, or move sideways
    bool inside = false;   ///< the camera stands in a room: turning about a point leads into walls
    glm::dvec3 keys{0.0};  ///< right, up, forward: -1, 0 or 1 each
    bool fast = false;     ///< Shift is held
    double seconds = 0;    ///< since the last frame
};

/// Turns input into camera moves. Orbit and turntable: drags turn about the pivot (orbit inside a room: look
/// around) and pan, scrolling moves toward the pivot. Fly and walk: drags look around, keys move, scrolling
/// sets the speed.
class Navigation {
 public:
    /// `scene_size`: the scene's diagonal, world units. It sets the initial flying speed.
    explicit Navigation(double scene_size) { set_scene(scene_size, 1); }
    void set_scene(double scene_size, double metres_per_unit);

    NavigationMode mode() const { return mode_; }
    void set_mode(NavigationMode mode) { mode_ = mode; }
    /// Whether drags turn the scene (orbit, turntable) instead of the direction of view (fly, walk).
    bool turns_scene() const { return mode_ == NavigationMode::orbit || mode_ == NavigationMode::turntable; }
    double speed() const {
        return mode_ == NavigationMode::walk ? walking_speed_ : speed_;
    }  ///< world units a second
    bool gravity() const { return gravity_; }
    void set_gravity(bool gravity) { gravity_ = gravity; }
    double eye_height() const { return eye_height_; }  ///< world units
    /// Sets the floor under the camera, world z, if it is known. Walking with gravity brings the camera to
    /// eye height above it.
    void set_floor(std::optional<double> floor) { floor_ = floor; }
    /// Moves the camera. Returns true if it moved.
    bool apply(const NavigationInput& input, CameraRig& rig);

 private:
    bool settle(double seconds, CameraRig& rig) const;

    NavigationMode mode_ = NavigationMode::orbit;
    double speed_ = 1, walking_speed_ = 1, eye_height_ = 1;
    bool gravity_ = true;
    std::optional<double> floor_;
};

}  // namespace lucarne::viewer
