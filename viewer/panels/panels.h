#pragma once

#include "viewer/view_model.h"

namespace lucarne::viewer {

class FileBrowser;

void draw_menu_bar(ViewModel& model);  ///< of the table of actions, with their keys

void draw_start_page(ViewModel& model);   ///< with nothing open
void draw_scans_panel(ViewModel& model);  ///< the tree of open scans, and how far loads and conversions are

void draw_bookmarks(ViewModel& model);
void draw_file_browser(ViewModel& model, FileBrowser& browser);
void draw_closing_question(ViewModel& model);  ///< where a conversion is running

// Each draws one ImGui window and writes the user's changes into the model.
void draw_settings_panel(ViewModel& model);            ///< engine, preset, bounces, exposure
void draw_view_panel(ViewModel& model);                ///< colours, sizes, shading, classes, clips
void draw_light_panel(ViewModel& model);               ///< lamps, suns, sky, classes that shine
void draw_sun(ViewModel& model);                       ///< inside it: where the selected sun stands
void draw_sky(ViewModel& model);
void draw_emitters(ViewModel& model);
void draw_statistics_panel(ViewModel& model);          ///< the last picture's figures
void draw_measure_panel(ViewModel& model);             ///< tools, measurements, points
void draw_measurements(ViewModel& model);              ///< over the picture
void draw_controller_panel(ViewModel& model);          ///< its mapping
void draw_help(ViewModel& model);                      ///< every action and gesture

inline constexpr float kViewPanelWidth = 22;  ///< of the font's height
void draw_overlay(const ViewModel& model);    ///< legend, axes, scale bar
/// Draws clip boxes and their handles, and lets the mouse drag those; true while it does.
bool take_clip_handles(ViewModel& model);
/// The same of lights' handles and of the border of a comparison.
bool take_light_handles(ViewModel& model);
void draw_convergence(const ViewModel& model);  ///< a ring that closes while pictures are averaged

void draw_message(const ViewModel& model, bool busy);  ///< one line at the bottom

}  // namespace lucarne::viewer
