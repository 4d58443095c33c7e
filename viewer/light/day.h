#pragma once

#include <optional>
#include <vector>

#include <glm/vec2.hpp>

#include "gi/scene/sun.h"
#include "viewer/light/lighting.h"

namespace lucarne::viewer {

// The sun's way through a day: as a film, and on a dial.

/// The sun at a moment, and where a dial shows it: the horizon is the circle of radius 1 about the origin,
/// the zenith its middle, north above (y = -1) and east on the right. Below the horizon it lies outside.
struct SunOnDial {
    gi::SunMoment moment;
    glm::dvec2 place{0.0};
    double elevation = 0;  ///< degrees
};
SunOnDial on_dial(const gi::SunMoment& moment);
/// Returns the sun of each tenth minute of the moment's day, by its clock.
std::vector<SunOnDial> day_on_dial(const gi::SunMoment& moment);
/// Returns that of `day` which is nearest to a place on the dial.
const SunOnDial* nearest_on_dial(const std::vector<SunOnDial>& day, const glm::dvec2& place);

/// Returns the moment after so many seconds of the same day, from whose end its begin follows. The night,
/// when the sun is more than kNight degrees below the horizon, is left out. None if all of the day is night.
inline constexpr double kNight = 6;
std::optional<gi::SunMoment> later_that_day(const gi::SunMoment& moment, int seconds);

/// Returns the scene's first sun; null without one.
const gi::SceneLight* first_sun(const gi::Scene& scene);
/// Returns its moment. A sun without one stands at the hour of SunMoment.
std::optional<gi::SunMoment> moment_of_sun(const gi::Scene& scene);
/// Begins or ends the film of the day.
void play_day(const Lighting& model);
/// Moves the sun by what `seconds` of the film show: an hour takes two seconds. Ends it if there is no sun.
void advance_day(const Lighting& model, double seconds);

}  // namespace lucarne::viewer
