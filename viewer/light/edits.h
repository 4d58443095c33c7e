#pragma once

#include "viewer/window/view_model.h"

namespace lucarne::viewer {

// What panel and keys do to the scene's lights, and to what is shown of them. Whatever adds or takes away a
// light can be undone.

/// A new light of a kind, selected, that shines on what the view turns about as bright as the exposure makes
/// mid-grey. No more than a scene file may hold.
void add_light(ViewModel& model, gi::LightKind kind);
void duplicate_light(ViewModel& model);
void remove_light(ViewModel& model);
/// Call before a change that undo_lights() takes back.
void remember_lights(ViewModel& model);
void undo_lights(ViewModel& model);
/// The selected one, on or off.
void switch_selected_light(ViewModel& model);
/// Lets the selected light come from the sun's place at a moment, or from where it comes from now.
void set_sun(ViewModel& model, const std::optional<gi::SunMoment>& sun);

/// Compares with another engine, or with none.
void compare_with(ViewModel& model, const std::string& engine);

/// The scene with what the window shows: its view is the first camera, named "view".
gi::Scene scene_to_save(const ViewModel& model);
/// light_tools.scene_file, or a name that is free.
std::filesystem::path scene_place(const ViewModel& model);
/// Writes over light_tools.scene_file alone; `path` is that from then on.
Result<void> save_scene_as(ViewModel& model, const std::filesystem::path& path);
/// In its place; says so in the message.
void save_scene(ViewModel& model);

}  // namespace lucarne::viewer
