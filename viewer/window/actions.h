#pragma once

#include <span>
#include <vector>

#include "viewer/window/key_chord.h"
#include "viewer/window/view_model.h"

namespace lucarne::viewer {

/// A command of the user: an item of a menu with a key. Keys, menus and the help are all built from these, so
/// that they always agree.
struct Action {
    KeyChord chord;
    const char* menu;  ///< its menu: "View", or "View/Projection" for a submenu
    const char* name;
    void (*run)(ViewModel& model);
    bool (*enabled)(const ViewModel& model) = nullptr;  ///< null: always enabled
    bool (*checked)(const ViewModel& model) = nullptr;  ///< null: the action is not a switch
};

// The actions of one part of the window, in the order of its menu. A new part adds a line here and in
// `actions()`.
std::span<const Action> file_actions();
std::span<const Action> view_actions();
std::span<const Action> look_actions();
std::span<const Action> bookmark_actions();
std::span<const Action> light_actions();
std::span<const Action> picture_actions();
std::span<const Action> measure_actions();
std::span<const Action> show_actions();
std::span<const Action> window_actions();

/// All actions, in the order of the menu bar. No action uses W, A, S, D, Q or E without a modifier: these
/// keys fly.
const std::vector<Action>& actions();

/// A gesture of navigation or lights, as the help lists it.
struct Gesture {
    const char* gesture;
    const char* what;
};
std::span<const Gesture> gestures();

/// Runs the enabled actions of the pressed keys.
void run_actions(ViewModel& model, std::span<const KeyChord> chords);

// Actions on the selected light. Positions are in world units.
void place_light_at_camera(ViewModel& model);
void aim_light(ViewModel& model, const glm::dvec3& target);
/// Moves the light and its target parallel to the picture. `shift` is in shares of the picture's height, to
/// the right and up.
void shift_light(ViewModel& model, const glm::dvec2& shift);

}  // namespace lucarne::viewer
