#pragma once

#include <span>
#include <string>

#include "viewer/ui/action.h"
#include "viewer/ui/view.h"

namespace lucarne::viewer {

/// What the actions and the panel of how pictures are made act on: engine, preset, exposure, comparison.
struct Rendering {
    View& view;
    bool& holds_border;  ///< the mouse drags a comparison's border
};

std::span<const Action<const Rendering>> rendering_actions();

void draw_rendering_panel(const Rendering& model);  ///< engine, preset, bounces, exposure
/// Draws the border of a comparison, and lets the mouse drag it. Returns true while it is dragged.
bool take_comparison_border(const Rendering& model);
void draw_convergence(const View& view);  ///< a ring that closes while pictures are averaged
float convergence_left();                 ///< where its plate begins in the window, x

/// Compares with another engine; an empty name ends the comparison.
void compare_with(View& view, const std::string& engine);

}  // namespace lucarne::viewer
