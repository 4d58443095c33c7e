#pragma once

#include <cstdint>
#include <string>
#include <string_view>

#include <glm/vec3.hpp>

#include "io/core/error.h"

namespace lucarne::gi {

/// An instant, and how far the clocks of its place are ahead of universal time.
struct Moment {
    int64_t seconds = 0;  ///< since 1970-01-01T00:00:00Z, without leap seconds
    int ahead = 0;        ///< minutes, -1439 to 1439
    bool operator==(const Moment&) const = default;
};

/// "2026-06-21T12:00:00+02:00" or with Z, of the years 1900 to 2100 (ISO 8601; seconds may be left out).
Result<Moment> parse_time(std::string_view text);
std::string time_text(const Moment& moment);

/// A moment's date and time of day where it is.
struct LocalTime {
    int year = 2026, month = 6, day = 21;
    int seconds = 43200;  ///< of the day
};
LocalTime local_time(const Moment& moment);
/// Days beyond the month's end count as its last, and years are kept within parse_time()'s.
Moment moment_of(const LocalTime& time, int ahead);

/// When and where the sun is looked for.
struct SunMoment {
    double latitude = 48.2, longitude = 16.37;  ///< degrees, north and east
    Moment time{1782036000, 120};
    double north = 0;  ///< degrees from the scan's +y to true north, clockwise seen from above
    bool operator==(const SunMoment&) const = default;
};

/// Degrees: the azimuth clockwise from north, the elevation over the horizon.
struct SolarPosition {
    double azimuth = 0, elevation = 0;
};

/// The middle of the sun without refraction (which lifts it by up to .6 degrees at the horizon), within .01
/// degrees from 1900 to 2100: NOAA's Solar Calculator, after Meeus 1998, "Astronomical Algorithms", chapters
/// 13, 25 and 28.
SolarPosition solar_position(const SunMoment& sun);
/// Unit, to the sun: x east, y north, z up, before the scan is turned by `north` degrees.
glm::dvec3 towards(const SolarPosition& sun, double north);

}  // namespace lucarne::gi
