#pragma once

#include <glm/vec3.hpp>

namespace lucarne::viewer {

/// The light of a clear day, linear Rec. 709.
struct ClearDay {
    glm::dvec3 sun{0.0};  ///< irradiance of a surface that faces the sun, W/m^2; 0 once it has set
    glm::dvec3 sky{0.0};  ///< radiance, the same from everywhere, W/(sr m^2)
    double dusk = 0;      ///< 0 by day to 1 when the sun has set
};

/// Returns the light for the sun's elevation, degrees. The sun is dimmed and reddened by the air: optical
/// depths of molecules and haze after Preetham, Shirley & Smits 1999 (appendix A.1, Angstrom's turbidity .1),
/// along the path of Kasten & Young 1989. The sky falls with the square root of the sine of the elevation, in
/// twilight by ten for every 4 degrees: simple curves, which are fitted to nothing.
ClearDay clear_day(double elevation);

}  // namespace lucarne::viewer
