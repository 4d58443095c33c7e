#pragma once

#include <glm/vec3.hpp>

#include "gi/scene/scene.h"
#include "gi/shared/luminance.h"

namespace lucarne::gi {

/// Lumens of a watt of white light, counting only the visible band: the value that Radiance uses (Ward &
/// Shakespeare 1998, "Rendering with Radiance", WHTEFFICACY). A colour in watts is weighted by Rec. 709's
/// luminance, so that [1, 1, 1] W are 179 lm.
inline constexpr double kLumensPerWatt = 179;

/// Returns the luminous flux of a spot, point, rectangle or disc, lm; for a directional light the
/// illuminance of a surface that faces it, lx. `metres_per_unit` is the scan's.
double luminous_flux(const SceneLight& light, double metres_per_unit);
/// Scales the strength to the given flux (or illuminance). A black light becomes white.
void set_luminous_flux(SceneLight& light, double lumens, double metres_per_unit);

/// Converts CIE 1931 XYZ to linear Rec. 709 (IEC 61966-2-1). Colours out of gamut get negative channels.
glm::dvec3 rec709_of(const glm::dvec3& xyz);

inline constexpr double kCoolest = 1667, kHottest = 25000;
/// Returns the linear Rec. 709 colour of a black body, its largest channel 1. `kelvin` is clamped to
/// kCoolest and kHottest. Source: Kim et al. 2002, US patent 7024034, cubic splines of the Planckian locus.
/// The white of daylight, [1, 1, 1], lies beside the locus.
inline constexpr double kDaylight = 6504;  ///< K, of the white of Rec. 709 (D65)
glm::dvec3 black_body_colour(double kelvin);
/// Returns the temperature of the black body that has this ratio of blue to red, in the same range.
double black_body_temperature(const glm::dvec3& colour);

}  // namespace lucarne::gi
