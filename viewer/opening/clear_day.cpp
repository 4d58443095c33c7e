#include "viewer/opening/clear_day.h"

#include <algorithm>
#include <cmath>

#include <glm/common.hpp>
#include <glm/exponential.hpp>
#include <glm/trigonometric.hpp>

#include "gi/scene/photometry.h"

namespace lucarne::viewer {
namespace {

constexpr double kHigh = 42;  ///< degrees: the elevation for which the strengths are given
constexpr double kSunKelvin = 5800, kSunIrradiance = 850;
const glm::dvec3 kHighSky(62, 76, 98), kDuskSky(14, 18, 30);
const glm::dvec3 kWavelengths(.61, .55, .465);  ///< um, of red, green and blue
constexpr double kTurbidity = .1;
constexpr double kTwilight = 3;     ///< degrees: from here the sky falls by ten for every kTenth
constexpr double kTenth = 4;        ///< degrees
constexpr double kDarkest = -12;    ///< degrees: the sky does not get darker
constexpr double kDuskBegins = 12;  ///< degrees

/// How many times the air straight above the light passes (Kasten & Young 1989).
double air_mass(double elevation) {
    return 1 / (std::sin(glm::radians(elevation)) + .50572 * std::pow(elevation + 6.07995, -1.6364));
}

glm::dvec3 transmitted(double elevation) {
    const glm::dvec3 molecules = .008735 * glm::pow(kWavelengths, glm::dvec3(-4.08));
    const glm::dvec3 haze = kTurbidity * glm::pow(kWavelengths, glm::dvec3(-1.3));
    return glm::exp(-air_mass(elevation) * (molecules + haze));
}

/// The sky's luminance, as a share of that for kHigh.
double share_of_sky(double elevation) {
    if (elevation >= kTwilight)
        return std::sqrt(std::sin(glm::radians(elevation)) / std::sin(glm::radians(kHigh)));
    return share_of_sky(kTwilight) * std::pow(10, (std::max(elevation, kDarkest) - kTwilight) / kTenth);
}

}  // namespace

ClearDay clear_day(double elevation) {
    ClearDay day;
    if (elevation > 0) {
        const glm::dvec3 colour = gi::black_body_colour(kSunKelvin);
        day.sun =
            colour * (kSunIrradiance / gi::luminance(colour)) * transmitted(elevation) / transmitted(kHigh);
    }
    day.dusk = std::clamp(1 - elevation / kDuskBegins, 0.0, 1.0);
    const glm::dvec3 colour =
        glm::mix(kHighSky / gi::luminance(kHighSky), kDuskSky / gi::luminance(kDuskSky), day.dusk);
    day.sky = colour * gi::luminance(kHighSky) * share_of_sky(elevation);
    return day;
}

}  // namespace lucarne::viewer
