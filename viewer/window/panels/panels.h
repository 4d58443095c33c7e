#pragma once

#include "viewer/window/view_model.h"

namespace lucarne::viewer {

class FileBrowser;

void draw_menu_bar(ViewModel& model);  ///< built from the table of actions

void draw_start_page(ViewModel& model);  ///< shown with nothing open
void draw_file_browser(ViewModel& model, FileBrowser& browser);
void draw_closing_question(ViewModel& model);  ///< lists unsaved and running work

/// Draws the open sections. Before the first view, draws only the sections that need no view.
void draw_side_bar(ViewModel& model, bool has_view);
// Each of these draws a section of the side bar and writes the user's changes into the model.
void draw_scans_panel(ViewModel& model);      ///< open scans, progress of loads and conversions
void draw_rendering_panel(ViewModel& model);  ///< engine, preset, bounces, exposure
void draw_look_panel(ViewModel& model);       ///< colours, sizes, shading, classes, clips
void draw_light_panel(ViewModel& model);      ///< lamps, suns, sky, emitting classes
void draw_sun(ViewModel& model);              ///< part of the light panel: direction of the selected sun
void draw_sky(ViewModel& model);
void draw_emitters(ViewModel& model);
void draw_measure_panel(ViewModel& model);  ///< tools, measurements, points
void draw_bookmarks_panel(ViewModel& model);
void draw_flythrough_panel(ViewModel& model);  ///< key frames, preview, rendering
void draw_picture_panel(ViewModel& model);     ///< a picture of any size
void draw_statistics_panel(ViewModel& model);  ///< figures of the last picture
void draw_controller_panel(ViewModel& model);  ///< mapping of the 6-DoF controller
/// Draws the heading of a collapsible part of a section. Returns whether the part is open.
bool fold(const char* label);

void draw_measurements(ViewModel& model);      ///< drawn over the picture
void draw_flythrough(const ViewModel& model);  ///< the path, drawn over the picture
void draw_help(ViewModel& model);              ///< every action and gesture
void draw_overlay(const ViewModel& model);     ///< legend, axes, scale bar
/// Draws clip boxes and their handles, and lets the mouse drag the handles. Returns true while one is
/// dragged.
bool take_clip_handles(ViewModel& model);
/// Does the same for lights' handles and the border of a comparison.
bool take_light_handles(ViewModel& model);
void draw_convergence(const ViewModel& model);  ///< a ring that closes while pictures are averaged

void draw_message(const ViewModel& model, bool busy);  ///< one line at the bottom

}  // namespace lucarne::viewer
