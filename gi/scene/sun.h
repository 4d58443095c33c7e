#pragma once

#include <cstdint>
#include <string>
#include <string_view>

#include <glm/vec3.hpp>

#include "io/core/error.h"

namespace lucarne::gi {

/// An instant, and how far local clocks are ahead of universal time.
struct Moment {
    int64_t seconds = 0;  ///< since 1970-01-01T00:00:00Z, without leap seconds
    int ahead = 0;        ///< minutes, -1439 to 1439
    bool operator==(const Moment&) const = default;
};

/// Parses "2026-06-21T12:00:00+02:00", or with Z for the zone, in the years 1900 to 2100 (ISO 8601; seconds
/// may be left out).
Result<Moment> parse_time(std::string_view text);
std::string time_text(const Moment& moment);

/// The date and time of day of a moment, by local clocks.
struct LocalTime {
    int year = 2026, month = 6, day = 21;
    int seconds = 43200;  ///< of the day
};
LocalTime local_time(const Moment& moment);
/// Returns the moment of a local time. A day beyond the end of the month becomes its last day; years are
/// clamped to those of parse_time().
Moment moment_of(const LocalTime& time, int ahead);

/// The place and time for which the sun's position is computed.
struct SunMoment {
    double latitude = 48.2, longitude = 16.37;  ///< degrees, north and east
    Moment time{1782036000, 120};
    double north = 0;  ///< degrees from the scan's +y to true north, clockwise seen from above
    bool operator==(const SunMoment&) const = default;
};

/// In degrees: the azimuth clockwise from north, the elevation above the horizon.
struct SolarPosition {
    double azimuth = 0, elevation = 0;
};

/// Returns the position of the sun's middle without refraction (which lifts it by up to .6 degrees at the
/// horizon), within .01 degrees from 1900 to 2100. Source: NOAA's Solar Calculator, after Meeus 1998,
/// "Astronomical Algorithms", chapters 13, 25 and 28.
SolarPosition solar_position(const SunMoment& sun);
/// Returns the unit direction to the sun in the scan's coordinates. With `north` = 0 x is east, y north and
/// z up; `north` as in SunMoment.
glm::dvec3 towards(const SolarPosition& sun, double north);

}  // namespace lucarne::gi
