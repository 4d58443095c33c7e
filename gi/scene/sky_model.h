#pragma once

#include <numbers>
#include <optional>
#include <vector>

#include <glm/vec3.hpp>

#include "gi/scene/environment.h"
#include "gi/scene/scene.h"

namespace lucarne::gi {

// Daylight of a cloudless sky: Preetham, Shirley & Smits 1999, "A Practical Analytic Model for Daylight". The
// sun's disc is apart from the sky, as a directional light. All colours are linear Rec. 709. The model gives
// luminances; kLumensPerWatt (photometry.h) turns them into the watts of white light that lamps have as well.

/// The range of turbidity. Below 2 the model's horizon becomes many times too bright; beyond 10 the air is
/// fog. Limits of the model: its sky has about twice the illuminance of a real clear one and its sun less, so
/// that both together are right within .1; at sunset its sky is ten times too bright.
inline constexpr double kLeastTurbidity = 2, kMostTurbidity = 10;
/// Radius of the sun's disc, radians: .2666 degrees, the mean over the year.
inline constexpr double kSunRadius = .2666 * std::numbers::pi / 180;

/// Returns the radiance from a unit direction, W/(sr m^2), without the sun's disc; black below the horizon.
/// For a sun below the horizon, which the paper does not cover, the sky is that of a sun on the horizon and
/// darkens by ten for every 2 degrees, to that of a moonless night at -14 degrees. `sky.ground` plays no
/// part.
glm::dvec3 sky_radiance(const SkySettings& sky, const glm::dvec3& direction);

/// Returns the irradiance of a surface that faces the sun, through the atmosphere, W/m^2 (the paper's
/// appendix A.1). `elevation` of the sun's middle is in degrees; at 0 and below there is no light.
glm::dvec3 sun_irradiance(double elevation, double turbidity);

/// Returns the sky as a picture, of whose lower half every texel is the radiance of even, diffuse ground that
/// sky and sun light.
Environment sky_environment(const SkySettings& sky);

/// Returns the unit direction to a scene's sun: its first directional light, whether that is on or off.
std::optional<glm::dvec3> direction_to_sun(const std::vector<SceneLight>& lights);
/// Makes daylight agree with the sun's position: the sky, if it is of this model, and the strength of suns
/// with `daylight`. Call after changes of a sun or of the sky's settings; fast if nothing has changed.
void update_daylight(Scene& scene);

}  // namespace lucarne::gi
