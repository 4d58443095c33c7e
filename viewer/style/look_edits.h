#pragma once

#include <string>
#include <vector>

#include "viewer/window/view_model.h"

namespace lucarne::viewer {

// What actions and the View panel do to the look of the points.

/// Whether the engine knows light.
bool is_lit(const ViewModel& model);
/// Light off, or on again with the engine that there was.
void switch_light(ViewModel& model);
/// Around the point that the camera turns about, a quarter of the scans' size.
void add_clip_box(ViewModel& model);
/// Through that point, facing away from the camera: what is nearer goes.
void add_clip_plane(ViewModel& model);
/// Of all parts, what colours can be asked of; further components as ".1" and so on.
std::vector<std::string> attribute_names(const octree::NodeSource& source);

}  // namespace lucarne::viewer
