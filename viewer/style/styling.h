#pragma once

#include <span>

#include "viewer/style/model.h"
#include "viewer/ui/action.h"
#include "viewer/ui/view.h"

namespace lucarne::viewer {

/// What the actions and panels of the points' look act on.
struct Styling {
    View& view;
    LookModel& look;
};

std::span<const Action<const Styling>> look_actions();

void draw_look_panel(const Styling& model);  ///< colours, sizes, shading, classes, clips
/// Draws clip boxes and their handles, and lets the mouse drag the handles. Returns true while one is
/// dragged.
bool take_clip_handles(const Styling& model);
void draw_overlay(const Styling& model);  ///< legend, axes, scale bar

}  // namespace lucarne::viewer
