#include "gi/scene/sun.h"

#include <algorithm>
#include <array>
#include <charconv>
#include <chrono>
#include <cmath>

#include <fmt/format.h>
#include <glm/trigonometric.hpp>

namespace lucarne::gi {
namespace {

constexpr int kFirstYear = 1900, kLastYear = 2100;
constexpr int kDay = 86400;

int64_t days_of(int year, int month, int day) {
    using namespace std::chrono;
    const year_month_day date{std::chrono::year(year), std::chrono::month(static_cast<unsigned>(month)),
                              std::chrono::day(static_cast<unsigned>(day))};
    return sys_days(date).time_since_epoch().count();
}

int days_in(int year, int month) {
    return static_cast<int>(month == 12 ? 31 : days_of(year, month + 1, 1) - days_of(year, month, 1));
}

/// Returns the number that the `count` digits of `text` from `at` on make; -1 if any of them is not a digit.
int digits(std::string_view text, size_t at, size_t count) {
    int value = 0;
    if (at + count > text.size()) return -1;
    for (size_t i = at; i < at + count; ++i) {
        if (text[i] < '0' || text[i] > '9') return -1;
        value = value * 10 + (text[i] - '0');
    }
    return value;
}

double sine(double degrees) {
    return std::sin(glm::radians(degrees));
}
double cosine(double degrees) {
    return std::cos(glm::radians(degrees));
}

}  // namespace

Result<Moment> parse_time(std::string_view text) {
    const auto wrong = [&] {
        return rejected(fmt::format("'{}'", text.substr(0, 40)),
                        "a time is written as 2026-06-21T12:00:00+02:00, of the years 1900 to 2100");
    };
    const auto between = [](int value, int least, int most) { return value >= least && value <= most; };
    const int year = digits(text, 0, 4), month = digits(text, 5, 2), day = digits(text, 8, 2);
    const int hour = digits(text, 11, 2), minute = digits(text, 14, 2);
    if (text.size() < 17 || text[4] != '-' || text[7] != '-' || text[10] != 'T' || text[13] != ':' ||
        !between(year, kFirstYear, kLastYear) || !between(month, 1, 12) ||
        !between(day, 1, days_in(year, month)) || !between(hour, 0, 23) || !between(minute, 0, 59))
        return wrong();
    size_t at = 16;
    int second = 0;
    if (text[at] == ':') {
        second = digits(text, 17, 2);
        if (!between(second, 0, 59)) return wrong();
        at = 19;
    }
    int ahead = 0;
    const std::string_view zone = text.substr(at);
    if (zone != "Z") {
        const int hours = digits(zone, 1, 2), minutes = digits(zone, 4, 2);
        if (zone.size() != 6 || zone[3] != ':' || (zone[0] != '+' && zone[0] != '-') ||
            !between(hours, 0, 23) || !between(minutes, 0, 59))
            return wrong();
        ahead = (zone[0] == '-' ? -1 : 1) * (60 * hours + minutes);
    }
    const int64_t local = days_of(year, month, day) * kDay + hour * 3600 + minute * 60 + second;
    return Moment{local - 60 * ahead, ahead};
}

LocalTime local_time(const Moment& moment) {
    using namespace std::chrono;
    const int64_t local = moment.seconds + 60 * int64_t{moment.ahead};
    const int64_t day = local >= 0 ? local / kDay : (local - kDay + 1) / kDay;
    const year_month_day date{sys_days(days(day))};
    return {static_cast<int>(date.year()), static_cast<int>(static_cast<unsigned>(date.month())),
            static_cast<int>(static_cast<unsigned>(date.day())), static_cast<int>(local - day * kDay)};
}

Moment moment_of(const LocalTime& time, int ahead) {
    const int year = std::clamp(time.year, kFirstYear, kLastYear), month = std::clamp(time.month, 1, 12);
    const int day = std::clamp(time.day, 1, days_in(year, month));
    const int64_t local = days_of(year, month, day) * kDay + std::clamp(time.seconds, 0, kDay - 1);
    return {local - 60 * int64_t{ahead}, ahead};
}

std::string time_text(const Moment& moment) {
    const LocalTime time = local_time(moment);
    const int minutes = std::abs(moment.ahead);
    const std::string zone = moment.ahead == 0 ? "Z"
                                               : fmt::format("{}{:02}:{:02}", moment.ahead < 0 ? '-' : '+',
                                                             minutes / 60, minutes % 60);
    return fmt::format("{:04}-{:02}-{:02}T{:02}:{:02}:{:02}{}", time.year, time.month, time.day,
                       time.seconds / 3600, time.seconds / 60 % 60, time.seconds % 60, zone);
}

SolarPosition solar_position(const SunMoment& sun) {
    // Universal time stands in for dynamical time, which was ahead by at most 70 s; the sun moves .0008
    // degrees meanwhile.
    const double days = static_cast<double>(sun.time.seconds) / kDay - 10957.5;  // since J2000
    const double t = days / 36525;                                               // centuries
    // Meeus eqs 25.2 to 25.4 and the equation of the centre below them.
    const double mean_longitude = 280.46646 + t * (36000.76983 + t * 0.0003032);
    const double anomaly = 357.52911 + t * (35999.05029 - t * 0.0001537);
    const double centre = (1.914602 - t * (0.004817 + t * 0.000014)) * sine(anomaly) +
                          (0.019993 - t * 0.000101) * sine(2 * anomaly) + 0.000289 * sine(3 * anomaly);
    // Nutation and aberration, p. 164.
    const double node = 125.04 - 1934.136 * t;
    const double longitude = mean_longitude + centre - 0.00569 - 0.00478 * sine(node);
    // Eqs 22.2 and 25.8.
    const double obliquity = 23 + 26.0 / 60 + 21.448 / 3600 -
                             t * (46.8150 + t * (0.00059 - t * 0.001813)) / 3600 + 0.00256 * cosine(node);
    const double declination = std::asin(sine(obliquity) * sine(longitude));
    const double ascension = glm::degrees(std::atan2(cosine(obliquity) * sine(longitude), cosine(longitude)));
    // Sidereal time at Greenwich, eq. 12.4, with nutation in longitude as above.
    const double sidereal = 280.46061837 + 360.98564736629 * days + 0.000387933 * t * t -
                            0.00478 * sine(node) * cosine(obliquity);
    const double hour_angle = sidereal + sun.longitude - ascension;
    // Eqs 13.5 and 13.6, the azimuth from north.
    const double phi = sun.latitude;
    const double east = -std::cos(declination) * sine(hour_angle);
    const double north =
        std::sin(declination) * cosine(phi) - std::cos(declination) * cosine(hour_angle) * sine(phi);
    const double up =
        std::sin(declination) * sine(phi) + std::cos(declination) * cosine(hour_angle) * cosine(phi);
    const double azimuth = glm::degrees(std::atan2(east, north));
    return {azimuth < 0 ? azimuth + 360 : azimuth, glm::degrees(std::asin(std::clamp(up, -1.0, 1.0)))};
}

glm::dvec3 towards(const SolarPosition& sun, double north) {
    const double azimuth = sun.azimuth + north;
    return {sine(azimuth) * cosine(sun.elevation), cosine(azimuth) * cosine(sun.elevation),
            sine(sun.elevation)};
}

}  // namespace lucarne::gi
