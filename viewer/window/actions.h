#pragma once

#include <span>
#include <vector>

#include "viewer/window/key_chord.h"
#include "viewer/window/view_model.h"

namespace lucarne::viewer {

/// Something the user can have done: an item of a menu, with a key. Keys, menus and the help are all made of
/// these, so that none can be missing anywhere.
struct Action {
    KeyChord chord;
    const char* menu;  ///< where it stands: "View", or "View/Projection" for a menu in a menu
    const char* name;
    void (*run)(ViewModel& model);
    bool (*enabled)(const ViewModel& model) = nullptr;  ///< none: always
    bool (*checked)(const ViewModel& model) = nullptr;  ///< none: it is no switch
};

// A room's actions, in the order of its menu. A new room adds its own line here and in `actions()`.
std::span<const Action> file_actions();
std::span<const Action> view_actions();
std::span<const Action> look_actions();
std::span<const Action> bookmark_actions();
std::span<const Action> light_actions();
std::span<const Action> picture_actions();
std::span<const Action> measure_actions();
std::span<const Action> show_actions();
std::span<const Action> window_actions();

/// All of them, in the order of the menu bar. W, A, S, D, Q and E alone are not among the keys: they fly.
const std::vector<Action>& actions();

/// The gestures that navigation and lights take, for the help.
struct Gesture {
    const char* gesture;
    const char* what;
};
std::span<const Gesture> gestures();

/// Runs the actions of keys that were pressed, as far as they are enabled.
void run_actions(ViewModel& model, std::span<const KeyChord> chords);

// Lights. Positions are world units.
void place_light_at_camera(ViewModel& model);
void aim_light(ViewModel& model, const glm::dvec3& target);
/// Moves the light, and what it points at with it, parallel to the picture; shares of its height, right and
/// up.
void shift_light(ViewModel& model, const glm::dvec2& shift);

}  // namespace lucarne::viewer
