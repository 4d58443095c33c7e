#pragma once

#include <span>
#include <vector>

#include "viewer/ui/action.h"
#include "viewer/window/view_model.h"

namespace lucarne::viewer {

// The window's own actions, in the order of their menus. Each feature has others in its folder.
std::span<const Action<ViewModel>> file_actions();
std::span<const Action<ViewModel>> edit_actions();
std::span<const Action<ViewModel>> view_actions();
std::span<const Action<ViewModel>> window_actions();

/// Returns the actions of the window and of all features, in the order of the menu bar. `model` must outlive
/// them. No action uses W, A, S, D, Q or E without a modifier: these keys fly. A new feature adds a line
/// there.
std::vector<BoundAction> bound_actions(ViewModel& model);

/// A gesture of navigation or lights, as the help lists it.
struct Gesture {
    const char* gesture;
    const char* what;
};
std::span<const Gesture> gestures();

/// Runs the enabled actions of the pressed keys.
void run_actions(std::span<const BoundAction> actions, std::span<const KeyChord> chords);

}  // namespace lucarne::viewer
