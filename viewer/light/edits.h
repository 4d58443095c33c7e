#pragma once

#include "viewer/window/view_model.h"

namespace lucarne::viewer {

// Edits of the scene's lights and of how light is shown, for the panel and the keys. Adding and removing
// lights can be undone.

/// Adds a light of a kind and selects it. The light shines on the point that the view turns about; its
/// strength makes a surface there look mid-grey at the current exposure. Does nothing if the scene has as
/// many lights as a scene file may contain.
void add_light(ViewModel& model, gi::LightKind kind);
void duplicate_light(ViewModel& model);
void remove_light(ViewModel& model);
/// Remembers the lights for undo_lights(). Call before a change.
void remember_lights(ViewModel& model);
void undo_lights(ViewModel& model);
/// Switches the selected light on or off.
void switch_selected_light(ViewModel& model);
/// Ties the selected light's direction to the sun's position at a moment. Without a moment, the light keeps
/// its current direction.
void set_sun(ViewModel& model, const std::optional<gi::SunMoment>& sun);

/// Compares with another engine; an empty name ends the comparison.
void compare_with(ViewModel& model, const std::string& engine);

/// Returns the scene as the window shows it. The window's view is its first camera, named "view".
gi::Scene scene_to_save(const ViewModel& model);
/// Returns the file for saving the scene: light_tools.scene_file, or a free name.
std::filesystem::path scene_place(const ViewModel& model);
/// Saves the scene to `path`, which becomes light_tools.scene_file. Overwrites no other file than
/// light_tools.scene_file.
Result<void> save_scene_as(ViewModel& model, const std::filesystem::path& path);
/// Saves the scene to scene_place() and reports that in the message.
void save_scene(ViewModel& model);

}  // namespace lucarne::viewer
