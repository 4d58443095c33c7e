#pragma once

#include "viewer/window/view_model.h"

namespace lucarne::viewer {

class FileBrowser;

void draw_menu_bar(ViewModel& model);  ///< of the table of actions, with their keys

void draw_start_page(ViewModel& model);  ///< with nothing open
void draw_file_browser(ViewModel& model, FileBrowser& browser);
void draw_closing_question(ViewModel& model);  ///< where work is unsaved or still running

/// The sections that are open. Before the first view there are only those that need none.
void draw_side_bar(ViewModel& model, bool has_view);
// Each draws a section of it and writes the user's changes into the model.
void draw_scans_panel(ViewModel& model);  ///< the tree of open scans, and how far loads and conversions are
void draw_rendering_panel(ViewModel& model);  ///< engine, preset, bounces, exposure
void draw_look_panel(ViewModel& model);       ///< colours, sizes, shading, classes, clips
void draw_light_panel(ViewModel& model);      ///< lamps, suns, sky, classes that shine
void draw_sun(ViewModel& model);              ///< inside it: where the selected sun stands
void draw_sky(ViewModel& model);
void draw_emitters(ViewModel& model);
void draw_measure_panel(ViewModel& model);  ///< tools, measurements, points
void draw_bookmarks_panel(ViewModel& model);
void draw_flythrough_panel(ViewModel& model);  ///< key frames, preview, rendering
void draw_picture_panel(ViewModel& model);     ///< a picture of any size
void draw_statistics_panel(ViewModel& model);  ///< the last picture's figures
void draw_controller_panel(ViewModel& model);  ///< its mapping
/// A part of a section under a line of its own; whether it is open.
bool fold(const char* label);

void draw_measurements(ViewModel& model);      ///< over the picture
void draw_flythrough(const ViewModel& model);  ///< the path over it
void draw_help(ViewModel& model);              ///< every action and gesture
void draw_overlay(const ViewModel& model);     ///< legend, axes, scale bar
/// Draws clip boxes and their handles, and lets the mouse drag those; true while it does.
bool take_clip_handles(ViewModel& model);
/// The same of lights' handles and of the border of a comparison.
bool take_light_handles(ViewModel& model);
void draw_convergence(const ViewModel& model);  ///< a ring that closes while pictures are averaged

void draw_message(const ViewModel& model, bool busy);  ///< one line at the bottom

}  // namespace lucarne::viewer
