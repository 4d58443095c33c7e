#pragma once

#include "viewer/light/lighting.h"

namespace lucarne::viewer {

// Edits of the scene's lights and of how light is shown, for the panel and the keys.

/// Adds a light of a kind and selects it. The light shines on the point that the view turns about; its
/// strength makes a surface there look mid-grey at the current exposure. Does nothing if the scene has as
/// many lights as a scene file may contain.
void add_light(const Lighting& model, gi::LightKind kind);
void duplicate_light(const Lighting& model);
void remove_light(const Lighting& model);
/// Switches the selected light on or off.
void switch_selected_light(const Lighting& model);
/// Ties the selected light's direction to the sun's position at a moment. Without a moment, the light keeps
/// its current direction.
void set_sun(const Lighting& model, const std::optional<gi::SunMoment>& sun);

/// Lights the scene by the sky of the daylight model, which follows the scene's sun. The sun gets the
/// strength of daylight. Without a sun, `sky.sun` counts.
void set_clear_sky(const Lighting& model, const gi::SkySettings& sky);

}  // namespace lucarne::viewer
