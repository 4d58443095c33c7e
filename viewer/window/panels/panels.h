#pragma once

#include <span>

#include "viewer/project/missing_scans.h"
#include "viewer/ui/action.h"
#include "viewer/window/view_model.h"

namespace lucarne::viewer {

void draw_menu_bar(ViewModel& model, std::span<const BoundAction> actions);

void draw_start_page(ViewModel& model);        ///< shown with nothing open
void draw_closing_question(ViewModel& model);  ///< lists unsaved and running work
void draw_missing_scans(MissingScans& question);

/// Draws the open sections: panels of the features, and those below. Before the first view, draws only the
/// sections that need no view.
void draw_side_bar(ViewModel& model, bool has_view);
void draw_statistics_panel(const ViewModel& model);  ///< figures of the last picture
void draw_controller_panel(ViewModel& model);        ///< mapping of the 6-DoF controller
void draw_preferences_panel(ViewModel& model);       ///< what the settings keep

void draw_help(bool& shown, std::span<const BoundAction> actions);  ///< every action and gesture
void draw_status_line(const ViewModel& model);                      ///< the point under the cursor
void draw_about(bool& shown);                                       ///< name, version, licence
void draw_message(const ViewModel& model, bool busy);               ///< one line at the bottom

}  // namespace lucarne::viewer
