#pragma once

#include <span>

#include "viewer/view_model.h"

namespace lucarne::viewer {

/// Something that a key does. The help lists these, so that none can be missing there.
struct Action {
    int key;  ///< as GLFW numbers it
    const char* key_name;
    const char* what;
    void (*run)(ViewModel& model);
};
std::span<const Action> actions();

/// The gestures that navigation and lights take, for the help.
struct Gesture {
    const char* gesture;
    const char* what;
};
std::span<const Gesture> gestures();

/// Runs the actions of keys that were pressed.
void run_actions(ViewModel& model, std::span<const int> keys);

// Lights. Positions are world units.
void place_light_at_camera(ViewModel& model);
void aim_light(ViewModel& model, const glm::dvec3& target);
/// Moves the light, and what it points at with it, parallel to the picture; shares of its height, right and
/// up.
void shift_light(ViewModel& model, const glm::dvec2& shift);

}  // namespace lucarne::viewer
