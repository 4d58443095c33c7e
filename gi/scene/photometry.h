#pragma once

#include <glm/vec3.hpp>

#include "gi/scene/scene.h"
#include "gi/shared/luminance.h"

namespace lucarne::gi {

/// Lumens that a watt of white light makes, of what lies in the visible band: what Radiance counts with (Ward
/// & Shakespeare 1998, "Rendering with Radiance", WHTEFFICACY). A colour in watts is weighted by Rec. 709's
/// luminance, so that [1, 1, 1] W are 179 lm.
inline constexpr double kLumensPerWatt = 179;

/// What a spot, point, rectangle or disc sends out, lm; of a directional light the illuminance of a surface
/// that faces it, lx. `metres_per_unit` is the scan's.
double luminous_flux(const SceneLight& light, double metres_per_unit);
/// Scales the strength; a light that is black becomes white.
void set_luminous_flux(SceneLight& light, double lumens, double metres_per_unit);

inline constexpr double kCoolest = 1667, kHottest = 25000;
/// Linear Rec. 709 of a black body, the largest channel 1; kelvin is kept within kCoolest to kHottest. Kim et
/// al. 2002, US patent 7024034, cubic splines of the Planckian locus; daylight's white [1, 1, 1] lies beside
/// it.
glm::dvec3 black_body_colour(double kelvin);

}  // namespace lucarne::gi
