#pragma once

#include <string>
#include <vector>

#include "viewer/style/styling.h"

namespace lucarne::viewer {

// Edits of the points' look, for the actions and the panel.

/// Whether the engine computes light.
bool is_lit(const Styling& model);
/// Switches light off, or on again with the previous engine.
void switch_light(const Styling& model);
/// Adds a clip box around the point that the camera turns about, with a quarter of the scans' size.
void add_clip_box(const Styling& model);
/// Adds a clip plane through that point, facing away from the camera. It removes what is nearer to the
/// camera.
void add_clip_plane(const Styling& model);
/// Returns the attributes of all parts that can be shown as colours; further components get ".1" and so on.
std::vector<std::string> attribute_names(const octree::NodeSource& source);

}  // namespace lucarne::viewer
